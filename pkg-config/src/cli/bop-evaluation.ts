/** Compares a results file of BOP with the true poses of a dataset. */
import { type BopDataset, type BopTarget, mostVisible } from "../bop-dataset.js";
import { bopId, readBopImage, readBopModel } from "../bop-folder.js";
import { fileNotFound } from "../case-files.js";
import { fromBop } from "../conventions/bop.js";
import { formatsModule } from "../formats-module.js";
import type { BopErrors } from "../generated/types.js";
import type { CoreFrame } from "../input/core-input.js";
import { resolveFrame } from "../input/frames.js";
import { readMesh } from "../input/mesh.js";
import { registrationModule } from "../registration-module.js";
import { type BopResult, METRES_PER_UNIT } from "./bop-results.js";
import { type BopScores, best, type ObjectErrors, scoresOf } from "./bop-scores.js";

/** An estimate with its errors relative to each true pose of the object in the image. */
export interface EvaluatedEstimate {
  sceneId: number;
  imageId: number;
  objectId: number;
  score: number;
  /** By the place of the true pose in `scene_gt.json`. */
  errors: Record<string, BopErrors>;
}

/** The scores of a results file. */
export interface BopEvaluation extends BopScores {
  /** Mean time per image, seconds; `null` if unknown. */
  secondsPerImage: number | null;
  /** The scores of each object, by its id. */
  objects: Record<string, BopScores>;
  poses: EvaluatedEstimate[];
}

const loadFormats = () => formatsModule.load();

/**
 * The errors and scores of results.
 * @param onProgress called with the number of targets that are done
 * @throws {@link Sim3AlignError}
 */
export async function evaluateBop(
  dataset: BopDataset,
  targets: readonly BopTarget[],
  results: readonly BopResult[],
  onProgress: (done: number) => void,
): Promise<BopEvaluation> {
  const reader = new ModelReader(dataset);
  const registrar = await registrationModule.load();
  const info = await dataset.info();
  const byTarget = grouped(results, keyOf);
  const found: ObjectErrors[] = [];
  const poses: EvaluatedEstimate[] = [];
  let view: { key: string; frame: CoreFrame } | undefined;
  for (const [done, target] of targets.entries()) {
    onProgress(done);
    const { sceneId, imageId, objectId, count } = target;
    const scene = await dataset.scene(sceneId);
    const all = mostVisible(scene, { ...target, count: Number.POSITIVE_INFINITY });
    if (all.length === 0) {
      const expected = "the true poses in scene_gt.json";
      throw fileNotFound("scene_gt.json", `no object ${objectId} in image ${imageId} of ${scene.folder}`, expected);
    }
    const model = info.get(objectId);
    if (model === undefined) {
      throw fileNotFound("models_info.json", `no object ${objectId}`, "an entry for each object of the targets");
    }
    const image = `${sceneId}/${imageId}`;
    if (view?.key !== image) {
      const files = await readBopImage(scene, bopId(imageId), false);
      view = { key: image, frame: (await resolveFrame(files, loadFormats)).core };
    }
    const { frame } = view;
    const estimates = best(byTarget.get(keyOf(target)) ?? [], count);
    const entries = scene.truths.get(bopId(imageId)) ?? [];
    const truths = all.map((place) => fromBop(entries[place] as (typeof entries)[number]));
    const { diameterMm, discrete, continuous } = model;
    const input = { ...frame, mesh: await reader.mesh(objectId), diameterM: METRES_PER_UNIT * diameterMm };
    const given = { ...input, discrete, continuous };
    const errors = registrar.call((module) =>
      module.bopErrors(
        given,
        estimates.map(({ pose }) => pose),
        truths,
      ),
    );
    const scored = estimates.map(({ score }, i) => ({
      score,
      errors: errors.slice(i * truths.length, (i + 1) * truths.length),
    }));
    for (const { score, errors: own } of scored) {
      const byPlace = Object.fromEntries(own.map((error, i) => [`${all[i]}`, error]));
      poses.push({ sceneId, imageId, objectId, score, errors: byPlace });
    }
    const isTarget = all.map((_, i) => i < count);
    const imageWidth = Number(frame.width);
    found.push({ sceneId, imageId, objectId, imageWidth, diameterMm, isTarget, estimates: scored });
  }
  const objects = grouped(found, ({ objectId }) => objectId);
  return {
    ...scoresOf(found),
    secondsPerImage: secondsPerImage(results),
    objects: Object.fromEntries([...objects].map(([id, own]) => [`${id}`, scoresOf(own)])),
    poses,
  };
}

function grouped<T, K>(items: readonly T[], keyOf: (item: T) => K): Map<K, T[]> {
  const groups = new Map<K, T[]>();
  for (const item of items) {
    const group = groups.get(keyOf(item));
    if (group === undefined) groups.set(keyOf(item), [item]);
    else group.push(item);
  }
  return groups;
}

const keyOf = ({ sceneId, imageId, objectId }: Pick<BopResult, "sceneId" | "imageId" | "objectId">) =>
  `${sceneId}/${imageId}/${objectId}`;

/** The mean over images, each of which has one time. */
function secondsPerImage(results: readonly BopResult[]): number | null {
  const times = new Map(results.map(({ sceneId, imageId, seconds }) => [`${sceneId}/${imageId}`, seconds]));
  const known = [...times.values()].filter((seconds) => seconds >= 0);
  return known.length === 0 ? null : known.reduce((sum, seconds) => sum + seconds, 0) / known.length;
}

/** Reads the models that errors are measured with, each once. */
class ModelReader {
  readonly #dataset: BopDataset;
  readonly #meshes = new Map<number, object>();

  constructor(dataset: BopDataset) {
    this.#dataset = dataset;
  }

  async mesh(objectId: number): Promise<object> {
    const known = this.#meshes.get(objectId);
    if (known !== undefined) return known;
    const file = await readBopModel(await this.#dataset.modelsOfErrors(), objectId);
    const { mesh } = await readMesh(file, loadFormats, false);
    this.#meshes.set(objectId, mesh);
    return mesh;
  }
}
