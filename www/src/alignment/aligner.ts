/** The page's aligner. */
import { type Aligner, type AlignInput, createAligner } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";

let created: Promise<Aligner> | undefined;

/** The aligner, created by the first call. After a failure, the next call tries again. */
export function aligner(): Promise<Aligner> {
  if (created === undefined) {
    const creation = createAligner({ workers: "auto" });
    creation.catch(() => {
      created = undefined;
    });
    created = creation;
  }
  return created;
}

const photoOf = ({ rgba, width, height }: Scene) => (rgba === null ? {} : { image: { data: rgba, width, height } });

/** What all objects of a scene share, in its present calibration. */
export const viewOf = (scene: Scene) => {
  const { depthM, width, height, camera } = scene;
  return { depth: depthM, width, height, camera, ...photoOf(scene) };
};

/** The same as it was given, for alignments that calibrate it. */
export function givenViewOf(scene: Scene) {
  const { raw, width, height } = scene;
  if (raw === null) return viewOf(scene);
  const { depth, depthKind, camera, focalUncertainty } = raw;
  const isGuess = focalUncertainty > 0;
  return {
    ...{ depth, width, height, depthKind },
    camera: isGuess ? { ...camera, focalUncertainty } : camera,
    ...photoOf(scene),
  };
}

/** The input of `align` and `evaluate` for an object. */
export const inputOf = (scene: Scene, { mask, mesh }: Pick<ObjectModel, "mask" | "mesh">): AlignInput => ({
  ...viewOf(scene),
  mask,
  mesh,
});
