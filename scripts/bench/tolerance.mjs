/** How near to the truth is near enough; `src/samples/benchmark.rs` has the same numbers. */

/** @typedef {{ scaleError: number, rotationErrorDeg: number, translationErrorRelative: number }} PoseErrors */

/** Scale within 5 %, rotation within 10° up to symmetry, translation within 5 % of the diameter. */
export const strict = { scale: 0.05, rotationDeg: 10, translation: 0.05 };
/** Twice as far. */
export const loose = { scale: 0.1, rotationDeg: 20, translation: 0.1 };

/**
 * Whether a pose is near enough; no answer is not.
 * @param {PoseErrors | null | undefined} errors
 * @param {typeof strict} tolerance
 */
export const isWithin = (errors, tolerance) =>
  !!errors &&
  errors.scaleError <= tolerance.scale &&
  errors.rotationErrorDeg <= tolerance.rotationDeg &&
  errors.translationErrorRelative <= tolerance.translation;
