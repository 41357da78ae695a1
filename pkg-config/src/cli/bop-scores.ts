/** Recall of BOP: estimates matched with true poses, over the thresholds of each error. */
import type { BopErrors } from "../generated/types.js";

/** Thresholds of correctness: .05 to .5 for VSD and, relative to the diameter, for MSSD. */
const SHARES = Array.from({ length: 10 }, (_, i) => 0.05 * (i + 1));
/** Thresholds of MSPD, in pixels of an image of this width. */
const PIXELS = Array.from({ length: 10 }, (_, i) => 5 * (i + 1));
const PIXELS_WIDTH = 640;
/** The threshold of ADD and ADD-S, relative to the diameter. */
const ADD_SHARE = 0.1;

/** The estimates of an object in an image, next to its true poses. */
export interface ObjectErrors {
  objectId: number;
  imageWidth: number;
  diameterMm: number;
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
export function scoresOf(objects: readonly ObjectErrors[]): BopScores {
  const targets = objects.reduce((sum, { isTarget }) => sum + isTarget.filter(Boolean).length, 0);
  type Value = (errors: BopErrors, object: ObjectErrors) => number;
  const recall = (value: Value, threshold: number) =>
    objects.reduce((sum, object) => sum + matches(object, (errors) => value(errors, object), threshold), 0) / targets;
  const average = (value: Value, thresholds: readonly number[]) => mean(thresholds.map((th) => recall(value, th)));
  const or = (value: number) => (targets === 0 ? null : value);
  const vsd = mean(SHARES.map((_, tau) => average((errors) => errors.vsd[tau] ?? 1, SHARES)));
  const mssd = average((errors, { diameterMm }) => errors.mssdMm / diameterMm, SHARES);
  const toPixels = (object: ObjectErrors) => PIXELS_WIDTH / object.imageWidth;
  const mspd = average((e, object) => (e.mspdPx ?? Number.POSITIVE_INFINITY) * toPixels(object), PIXELS);
  return {
    averageRecall: or(mean([vsd, mssd, mspd])),
    vsd: or(vsd),
    mssd: or(mssd),
    mspd: or(mspd),
    add: or(recall((errors, { diameterMm }) => errors.addMm / diameterMm, ADD_SHARE)),
    addS: or(recall((errors, { diameterMm }) => errors.addSMm / diameterMm, ADD_SHARE)),
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
