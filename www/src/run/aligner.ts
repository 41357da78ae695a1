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

/** What all objects of a scene share. */
export const viewOf = ({ depthM, width, height, camera, rgba }: Scene) => ({
  depth: depthM,
  width,
  height,
  camera,
  ...(rgba === null ? {} : { image: { data: rgba, width, height } }),
});

/** The input of `align` and `evaluate` for an object. */
export const inputOf = (scene: Scene, { mask, mesh }: ObjectModel): AlignInput => ({ ...viewOf(scene), mask, mesh });
