/** Compares a results file of BOP with the true poses of a dataset. */
import { type BopDataset, type BopTarget, imageKey, mostVisible, targetKey } from "../bop-dataset.js";
import { bopId, readBopImage } from "../bop-folder.js";
import { fileNotFound } from "../case-files.js";
import { fromBop } from "../conventions/bop.js";
import type { BopErrors } from "../generated/types.js";
import type { CoreFrame } from "../input/core-input.js";
import { resolveFrame } from "../input/resolve.js";
import { registrationModule } from "../modules/modules.js";
import { fileReaders } from "../modules/readers.js";
import { bopModelsIn } from "./bop-models.js";
import { type BopResult, METRES_PER_UNIT } from "./bop-results.js";
import { type BopScores, best, grouped, type ObjectErrors, scoresOf } from "./bop-scores.js";

/** An estimate with its errors relative to each true pose of the object in the image. */
export interface EvaluatedEstimate extends Omit<BopTarget, "count"> {
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
    const key = imageKey(target);
    if (view?.key !== key) {
      const files = await readBopImage(scene, bopId(imageId), false);
      view = { key, frame: (await resolveFrame(files, fileReaders)).core };
    }
    const { frame } = view;
    const estimates = best(byTarget.get(targetKey(target)) ?? [], count);
    const entries = scene.truths.get(bopId(imageId)) ?? [];
    const truths = all.map((place) => fromBop(entries[place] as (typeof entries)[number]));
    const { diameterMm, discrete, continuous } = model;
    const mesh = await modelOf(objectId);
    const given = { ...frame, mesh, diameterM: METRES_PER_UNIT * diameterMm, discrete, continuous };
    const errors = registrar.call((module) =>
      module.bopErrors(
        given,
        estimates.map(({ pose }) => pose),
        truths,
      ),
    );
    const byEstimate = estimates.map((_, i) => errors.slice(i * truths.length, (i + 1) * truths.length));
    for (const [i, { score }] of estimates.entries()) {
      const byPlace = Object.fromEntries((byEstimate[i] ?? []).map((error, k) => [`${all[k]}`, error]));
      poses.push({ sceneId, imageId, objectId, score, errors: byPlace });
    }
    const isTarget = all.map((_, i) => i < count);
    const imageWidth = Number(frame.width);
    found.push({ objectId, imageWidth, diameterMm, isTarget, estimates: byEstimate });
  }
  const objects = grouped(found, ({ objectId }) => objectId);
  return {
    ...scoresOf(found),
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
