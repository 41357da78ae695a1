/** What the values of a depth map are. */

/**
 * What the values of a depth map are:
 *
 * - `"metric"`: distances along the optical axis in a known unit;
 * - `"scale-invariant"`: such distances times an unknown factor;
 * - `"affine-invariant"`: such distances times an unknown factor, plus an unknown shift;
 * - `"affine-invariant-disparity"`: inverse distances times an unknown factor, plus an unknown shift; near is large.
 */
export type DepthKind = "metric" | "scale-invariant" | "affine-invariant" | "affine-invariant-disparity";

/** The kinds, the default first; the readers and the aligner know the same. */
export const depthKinds: readonly DepthKind[] = [
  ...(["metric", "scale-invariant", "affine-invariant", "affine-invariant-disparity"] as const),
];

/** Whether values of this kind have no zero: those that are zero or negative are values, and 8 bits may hold them. */
export const isAffineInvariant = (kind: DepthKind | undefined): boolean =>
  kind === "affine-invariant" || kind === "affine-invariant-disparity";
