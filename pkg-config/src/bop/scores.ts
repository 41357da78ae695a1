/** The scores of BOP: results next to the true poses of a dataset, and recalls over the thresholds of each error. */
import { fileNotFound } from "../case-files.js";
import { fromBop } from "../conventions/bop.js";
import type { BopErrors } from "../generated/types.js";
import { readMesh } from "../input/mesh.js";
import { resolveFrame } from "../input/resolve.js";
import type { CoreFrame } from "../modules/core-input.js";
import { registrationModule } from "../modules/modules.js";
import { fileReaders } from "../modules/readers.js";
import { oncePerKey } from "../values/validation.js";
import { type BopDataset, type BopPlace, type BopTarget, imageKey, readBopModel, targetKey } from "./dataset.js";
import type { BopResult } from "./files.js";

/** The models in a folder by their ids, each read once: arrays in millimetres, and the warnings of the reader. */
export const bopModelsIn = (folder: string, withColors: boolean): ((objectId: number) => Promise<object>) =>
  oncePerKey(async (objectId) => {
    const file = await readBopModel(folder, objectId);
    const { mesh, warnings } = await readMesh(file, fileReaders, withColors);
    return { ...mesh, warnings };
  });

/** An estimate with its errors relative to each true pose of the object in the image. */
export interface EvaluatedEstimate extends BopPlace {
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
  const modelOf = bopModelsIn(await dataset.modelsOfErrors(), false);
  const registrar = await registrationModule.load();
  const info = await dataset.info();
  const byTarget = grouped(results, targetKey);
  const measured: ObjectErrors[] = [];
  const poses: EvaluatedEstimate[] = [];
  let view: { key: string; frame: CoreFrame } | undefined;
  for (const [done, target] of targets.entries()) {
    onProgress(done);
    const { count, ...place } = target;
    const { sceneId, imageId, objectId } = place;
    const scene = await dataset.scene(sceneId);
    const all = scene.mostVisible(place);
    if (all.length === 0) {
      const expected = "the true poses in scene_gt.json";
      throw fileNotFound("scene_gt.json", `no object ${objectId} in image ${imageId} of ${scene.folder}`, expected);
    }
    const model = info.get(objectId);
    if (model === undefined) {
      throw fileNotFound("models_info.json", `no object ${objectId}`, "an entry for each object of the targets");
    }
    const key = imageKey(target);
    if (view?.key !== key) {
      const files = await scene.image(imageId, false);
      view = { key, frame: (await resolveFrame(files, fileReaders)).core };
    }
    const { frame } = view;
    const estimates = best(byTarget.get(targetKey(target)) ?? [], count);
    const entries = scene.posesIn(imageId);
    const truths = all.map((place) => fromBop(entries[place] as (typeof entries)[number]));
    const { diameterM, discrete, continuous } = model;
    const mesh = await modelOf(objectId);
    const given = { ...frame, mesh, diameterM, discrete, continuous };
    const found = estimates.map(({ pose }) => pose);
    const errors = registrar.call((module) => module.bopErrors(given, found, truths));
    const byEstimate = estimates.map((_, i) => errors.slice(i * truths.length, (i + 1) * truths.length));
    for (const [i, { score }] of estimates.entries()) {
      const byPlace = Object.fromEntries((byEstimate[i] ?? []).map((error, k) => [`${all[k]}`, error]));
      poses.push({ ...place, score, errors: byPlace });
    }
    const isTarget = all.map((_, i) => i < count);
    measured.push({ objectId, imageWidth: Number(frame.width), diameterM, isTarget, estimates: byEstimate });
  }
  const objects = grouped(measured, ({ objectId }) => objectId);
  return {
    ...scoresOf(measured),
    secondsPerImage: secondsPerImage(results),
    objects: Object.fromEntries([...objects].map(([id, own]) => [`${id}`, scoresOf(own)])),
    poses,
  };
}

/** The mean over images, each of which has one time. */
function secondsPerImage(results: readonly BopResult[]): number | null {
  const times = new Map(results.map((result) => [imageKey(result), result.seconds]));
  const known = [...times.values()].filter((seconds) => seconds >= 0);
  return known.length === 0 ? null : known.reduce((sum, seconds) => sum + seconds, 0) / known.length;
}

/** Thresholds of correctness: .05 to .5 for VSD and, relative to the diameter, for MSSD. */
const SHARES = Array.from({ length: 10 }, (_, i) => 0.05 * (i + 1));
/** Thresholds of MSPD, in pixels of an image of this width. */
const PIXELS = Array.from({ length: 10 }, (_, i) => 5 * (i + 1));
const PIXELS_WIDTH = 640;
/** The threshold of ADD and ADD-S, relative to the diameter. */
const ADD_SHARE = 0.1;

/** The estimates of an object in an image, next to its true poses. */
interface ObjectErrors {
  objectId: number;
  imageWidth: number;
  diameterM: number;
  /** Whether each true pose is to be found; the others may be matched by none. */
  isTarget: readonly boolean[];
  /** The errors of each estimate relative to each true pose; the estimate with the highest score first. */
  estimates: readonly (readonly BopErrors[])[];
}

/** Recalls of a dataset, 0 to 1; `null` without targets. */
export interface BopScores {
  /** AR: the mean of the three average recalls. */
  averageRecall: number | null;
  /** Average recall of VSD over tolerances and thresholds. */
  vsd: number | null;
  /** Average recall of MSSD over thresholds. */
  mssd: number | null;
  /** Average recall of MSPD over thresholds. */
  mspd: number | null;
  /** Recall of ADD below a tenth of the diameter. */
  add: number | null;
  /** Recall of ADD-S below a tenth of the diameter. */
  addS: number | null;
  /** Number of poses to be found. */
  targets: number;
  /** Number of estimates that are evaluated. */
  estimates: number;
}

/** The scores of all objects in all images. */
function scoresOf(objects: readonly ObjectErrors[]): BopScores {
  const targets = objects.reduce((sum, { isTarget }) => sum + isTarget.filter(Boolean).length, 0);
  type Value = (errors: BopErrors, object: ObjectErrors) => number;
  const recall = (value: Value, threshold: number) =>
    objects.reduce((sum, object) => sum + matches(object, (errors) => value(errors, object), threshold), 0) / targets;
  const average = (value: Value, thresholds: readonly number[]) => mean(thresholds.map((th) => recall(value, th)));
  const or = (value: number) => (targets === 0 ? null : value);
  const vsd = mean(SHARES.map((_, tau) => average((errors) => errors.vsd[tau] ?? 1, SHARES)));
  const mssd = average((errors, { diameterM }) => errors.mssdM / diameterM, SHARES);
  const toPixels = (object: ObjectErrors) => PIXELS_WIDTH / object.imageWidth;
  const mspd = average((e, object) => (e.mspdPx ?? Number.POSITIVE_INFINITY) * toPixels(object), PIXELS);
  return {
    averageRecall: or(mean([vsd, mssd, mspd])),
    vsd: or(vsd),
    mssd: or(mssd),
    mspd: or(mspd),
    add: or(recall((errors, { diameterM }) => errors.addM / diameterM, ADD_SHARE)),
    addS: or(recall((errors, { diameterM }) => errors.addSM / diameterM, ADD_SHARE)),
    targets,
    estimates: objects.reduce((sum, { estimates }) => sum + estimates.length, 0),
  };
}

/** The estimates with the highest scores, in their order; of equal scores, those that come first. */
export const best = <T extends { score: number }>(estimates: readonly T[], count: number): T[] =>
  [...estimates].sort((a, b) => b.score - a.score).slice(0, count);

/** Items by their keys, in their order. */
export function grouped<T, K>(items: readonly T[], keyOf: (item: T) => K): Map<K, T[]> {
  const groups = new Map<K, T[]>();
  for (const item of items) {
    const key = keyOf(item);
    const group = groups.get(key);
    if (group === undefined) groups.set(key, [item]);
    else group.push(item);
  }
  return groups;
}

/**
 * Number of targets that are found: each estimate, in the order of the scores, takes the free target with the smallest error
 * below the threshold.
 */
function matches(
  { isTarget, estimates }: ObjectErrors,
  value: (errors: BopErrors) => number,
  threshold: number,
): number {
  const taken = new Set<number>();
  for (const errors of estimates) {
    let nearest = -1;
    let smallest = threshold;
    for (const [truth, error] of errors.entries()) {
      const found = value(error);
      if (isTarget[truth] !== true || taken.has(truth) || !(found < smallest)) continue;
      [nearest, smallest] = [truth, found];
    }
    if (nearest >= 0) taken.add(nearest);
  }
  return taken.size;
}

const mean = (values: readonly number[]) => values.reduce((sum, value) => sum + value, 0) / values.length;
