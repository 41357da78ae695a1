// Generated from the Rust structs by tests/suite/typescript.rs; do not edit.

import type { Direction, ScaleBounds, Sim3Like, SymmetryOption } from "../argument-types.js";

/**
 * Which method runs.
 */
export type Preset = "precise" | "paper";

/**
 * How much work `precise` puts in.
 */
export type Quality = "fast" | "balanced" | "best";

/**
 * Where `precise` searches.
 */
export type SearchScope = "global" | "local";

/**
 * Which side of the mesh's box a known length is that of.
 */
export type ExtentAxis = "longest" | "x" | "y" | "z";

/**
 * What RANSAC does with a hypothesis whose scale leaves the guard.
 */
export type GuardMode = "reject" | "clamp";

/**
 * What ICP minimises.
 */
export type Icp = "point-to-plane" | "point-to-point" | "none";

/**
 * Options of `align`. All have defaults; most callers need none.
 *
 * An option whose documentation begins with the name of a preset has no effect under the other one.
 */
export type AlignOptions = { 
/**
 * The method. Default `"precise"`.
 */
preset: Preset, 
/**
 * `precise`: how much work. Default `"balanced"`.
 */
quality: Quality, 
/**
 * `precise`: what is known of the scale, in metres per mesh unit, above 0: a number fixes it (1 for a mesh that
 * is in metres), `[min, max]` or `{ min, max }` bounds it, `null` leaves it free. Not together with
 * `knownExtentM`. Default `null`.
 */
scale: ScaleBounds | null, 
/**
 * `precise`: the length of the object along `knownExtentAxis`, in metres, above 0, which fixes the scale: for
 * "this mug is 9.5 cm tall" and a mesh whose y axis is up, `{ knownExtentM: 0.095, knownExtentAxis: "y" }`. `null`
 * where it is not known. Default `null`.
 */
knownExtentM: number | null, 
/**
 * `precise`: the side of the mesh's box that `knownExtentM` is the length of. Default `"longest"`.
 */
knownExtentAxis: ExtentAxis, 
/**
 * `precise`: the direction that is up, against gravity, in the camera's frame (OpenCV: y is down), of any length
 * above 0: `[0, -1, 0]` for a level camera. Together with `meshUp`, it favours poses in which the object stands
 * upright. Default `null`.
 */
cameraUp: Direction | null, 
/**
 * `precise`: the direction that is up in the mesh's frame, of any length above 0: `[0, 1, 0]` for glTF. It belongs
 * to `cameraUp`. Default `null`.
 */
meshUp: Direction | null, 
/**
 * `precise`: the turns under which the object looks the same, so that no pose is listed among the alternatives
 * that only repeats another one. `"auto"` finds the half turns about the principal axes that the mesh itself shows,
 * `"auto-revolution"` those axes about which it can be turned by any angle, too; `[{ axis: [0, 1, 0], fold: 4 }]`
 * declares a quarter turn about the mesh's y axis, without `fold` any turn about it. Default `"auto"`.
 */
symmetry: SymmetryOption, 
/**
 * `precise`: a pose to start from, camera from mesh, in metres, such as the generator's own or an annotator's:
 * whatever `evaluate` takes as a transform, or `null`. Its scale has to be within `scale`. Default `null`.
 */
initial: Sim3Like | null, 
/**
 * `precise`: where to search: everywhere, or around `initial` only, which it then needs. Default `"global"`.
 */
search: SearchScope, 
/**
 * `precise`: a bound on the work of the search, above 0, in milliseconds of a machine of 2020; the work is
 * counted, not timed, so that the result does not depend on the machine. `null` leaves it to `quality`. Default
 * `null`.
 */
budgetMs: number | null, 
/**
 * Seed of all random draws, 0 to 2³² − 1. The same input and seed give the same bits. Default 0.
 */
seed: number, 
/**
 * Depth readings inside the mask that are used at most, 32 to 1 000 000; of more, an even random share is
 * drawn. `precise` uses them for metrics and initial scale alone. Default 20 000.
 */
maxObservedPoints: number, 
/**
 * Points sampled from the mesh surface, 100 to 1 000 000. `precise` uses them for metrics and initial scale alone.
 * Default 20 000.
 */
surfaceSamples: number, 
/**
 * `paper`: voxels along the observation's box diagonal, 5 to 200: the voxel size is the diagonal divided by this
 * (paper: 20, 30, 50). Default 30.
 */
voxelDivisions: number, 
/**
 * `paper`: radius of the FPFH descriptors, in voxels, 1 to 20. Default 5.
 */
fpfhRadiusVoxels: number, 
/**
 * `paper`: bounds [λmin, λmax] of the scale relative to the initial scale, 0 < λmin ≤ 1 ≤ λmax; `null` lets the
 * scale go anywhere (the ablation). Default [0.5, 1.5].
 */
guard: [number, number] | null, 
/**
 * `paper`: what happens to hypotheses outside the guard. Default `"reject"`.
 */
guardMode: GuardMode, 
/**
 * `paper`: minimal sets that RANSAC draws at most, 1 to 10 000 000. Default 100 000.
 */
ransacIterations: number, 
/**
 * `paper`: RANSAC stops early at this probability of having missed nothing better, 0 to 0.999999.
 * Default 0.999.
 */
ransacConfidence: number, 
/**
 * `paper`: a match within this distance of its counterpart is an inlier, in voxels, 0.1 to 20. Default 1.5.
 */
inlierDistanceVoxels: number, 
/**
 * `paper`: how alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1.
 * Default 0.9.
 */
edgeSimilarity: number, 
/**
 * `paper`: whether mesh regions that the observation does not support are left out. Default `true`.
 */
hallucinationFilter: boolean, 
/**
 * `paper`: support: largest distance to an observed point, in voxels, 0.1 to 50; ICP tightens it to a third as
 * the pose improves. Default 3.
 */
supportDistanceVoxels: number, 
/**
 * `paper`: support: largest angle between the two normals, in degrees, 0 to 180. Default 60.
 */
supportAngleDeg: number, 
/**
 * `paper`: the refinement. Default `"point-to-plane"`.
 */
icp: Icp, 
/**
 * Whether the refinement leaves the scale alone. Under `paper` it stays as RANSAC found it (§3.3; `false` is the
 * ablation); under `precise` it stays that of `initial` or, without it, as the grid of rotations found it. `null`
 * is `true` for `paper` and `false` for `precise`. Default `null`.
 */
lockScale: boolean | null, 
/**
 * `paper`: ICP iterations at most, 1 to 1 000. Default 60.
 */
icpIterations: number, };

/**
 * Options of `register`.
 */
export type RegisterOptions = { 
/**
 * Seed of all random draws, 0 to 2³² − 1. Default 0.
 */
seed: number, 
/**
 * Points of each cloud that are used at most, 32 to 1 000 000: of more, a random share or, with a fixed scale, the
 * means of small voxels. Default 20 000.
 */
maxPoints: number, 
/**
 * Voxel size in target units, above 0; `null` derives it from `voxelDivisions`. Default `null`.
 */
voxelSize: number | null, 
/**
 * Voxels along the target's box diagonal, 5 to 200; `null` takes 30 or, with a fixed scale, a voxel that leaves
 * 5000 points of the larger cloud. Default `null`.
 */
voxelDivisions: number | null, 
/**
 * Radius of the FPFH descriptors, in voxels, 1 to 20. Default 5.
 */
fpfhRadiusVoxels: number, 
/**
 * Minimal sets that RANSAC draws at most, 1 to 10 000 000; with a fixed scale, which needs no draws, at most so
 * many poses are tried, and no more than 100. Default 100 000.
 */
ransacIterations: number, 
/**
 * RANSAC stops early at this probability of having missed nothing better, 0 to 0.999999; without effect where the
 * scale is fixed. Default 0.999.
 */
ransacConfidence: number, 
/**
 * A match within this distance of its counterpart is an inlier, in voxels, 0.1 to 20. Default 1.5.
 */
inlierDistanceVoxels: number, 
/**
 * How alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1;
 * without effect where the scale is fixed. Default 0.9.
 */
edgeSimilarity: number, 
/**
 * The refinement. Default `"point-to-plane"`.
 */
icp: Icp, 
/**
 * ICP iterations at most, 1 to 1 000. Default 60.
 */
icpIterations: number, };

/**
 * Options of `estimateSim3`.
 */
export type EstimateOptions = { 
/**
 * Seed of all random draws, 0 to 2³² − 1. Default 0.
 */
seed: number, 
/**
 * A correspondence whose source lands within this of its target is an inlier, in target units, above 0;
 * `null` takes a twentieth of the target's box diagonal. Default `null`.
 */
inlierDistance: number | null, 
/**
 * Minimal sets that RANSAC draws at most, 1 to 10 000 000. Default 100 000.
 */
ransacIterations: number, 
/**
 * RANSAC stops early at this probability of having missed nothing better, 0 to 0.999999.
 * Default 0.999.
 */
ransacConfidence: number, 
/**
 * How alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1.
 * Default 0.9.
 */
edgeSimilarity: number, };

/**
 * Options of `evaluate`.
 */
export type EvaluateOptions = { 
/**
 * Seed of all random draws, 0 to 2³² − 1. Default 0.
 */
seed: number, 
/**
 * Depth readings inside the mask that are used at most, 32 to 1 000 000. Default 20 000.
 */
maxObservedPoints: number, 
/**
 * Points sampled from the mesh surface, 100 to 1 000 000. Default 20 000.
 */
surfaceSamples: number, };

/**
 * A stage of the pipeline.
 */
export type Stage = "observe" | "sample" | "normals" | "features" | "matching" | "ransac" | "filter" | "icp" | "prepare" | "search" | "refine" | "metrics";

/**
 * What went wrong, as a name that stays the same from release to release.
 *
 * In JavaScript it is the `code` of a `Sim3AlignError`, spelled as [`ErrorCode::as_str`] spells it.
 */
export type ErrorCode = "INVALID_ARGUMENT" | "INVALID_OPTION" | "UNKNOWN_OPTION" | "WRONG_LENGTH" | "EMPTY_IMAGE" | "SIZE_MISMATCH" | "INVALID_CAMERA" | "EMPTY_MASK" | "NO_DEPTH_IN_MASK" | "FLAT_DEPTH" | "TOO_FEW_POINTS" | "EMPTY_MESH" | "INDEX_OUT_OF_RANGE" | "NON_FINITE" | "DEGENERATE_MESH" | "DEGENERATE_POINTS" | "NO_CONSENSUS" | "INVALID_TRANSFORM" | "UNSUPPORTED_FORMAT" | "CORRUPT_FILE" | "FILE_TOO_LARGE" | "EIGHT_BIT_DEPTH" | "COMPRESSED_MESH" | "INTERNAL";

/**
 * The kinds of warning.
 */
export type WarningCode = "DEPTH_LOOKS_LIKE_MILLIMETRES" | "MASK_TOUCHES_BORDER" | "SPARSE_DEPTH" | "SCALE_CLAMPED" | "SCALE_COLLAPSED" | "NOT_CONVERGED";

/**
 * Something about the input that the caller should know; the result stands.
 */
export type Warning = { 
/**
 * A stable name.
 */
code: WarningCode, 
/**
 * What was found and what to do about it.
 */
message: string, };

/**
 * A similarity y = s·R·x + t in every form that callers ask for.
 */
export type Sim3 = { 
/**
 * s, target units per source unit; for `align`, metres per mesh unit.
 */
scale: number, 
/**
 * R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF).
 */
rotation: [number, number, number, number], 
/**
 * R as three rows of three.
 */
rotationMatrix: [[number, number, number], [number, number, number], [number, number, number]], 
/**
 * t, in target units; for `align`, metres.
 */
translation: [number, number, number], 
/**
 * The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU).
 */
matrix: [number, number, number, number, number, number, number, number, number, number, number, number, number, number, number, number], };

/**
 * Agreement of a posed mesh with the observation. `null` is "nothing to measure", never a good number.
 */
export type Metrics = { 
/**
 * DAVIS boundary F-measure of mask and rendered silhouette at 0.008 × the image diagonal, 0 to 1, higher is
 * better; 0 where nothing is rendered.
 */
boundaryF: number | null, 
/**
 * Distance of the centroids of mask and rendered silhouette, pixels; `null` where nothing is rendered.
 */
centerDriftPx: number | null, 
/**
 * Intersection over union of mask and rendered silhouette, 0 to 1, higher is better; 0 where nothing is
 * rendered or nothing overlaps.
 */
iou: number | null, 
/**
 * Mean of the two directional mean distances between observed points and surface, millimetres. The surface's
 * unseen side counts, so that it is above 0 at the true pose too.
 */
chamferMm: number | null, 
/**
 * Mean distance from the observed points to the surface, millimetres.
 */
uniChamferMm: number | null, 
/**
 * Share of the observed points within 5 % of their box diagonal of the surface, 0 to 1.
 */
fitness: number | null, 
/**
 * Mean |n·n′| of an observed point's normal and that of the nearest triangle, 0 to 1; random directions
 * give 0.5. `null` where no point has a normal.
 */
normalConsistency: number | null, 
/**
 * Mean |rendered − observed| depth over the mask's pixels that have both, millimetres; `null` where none has.
 */
depthMaeMm: number | null, };

/**
 * How far an estimate is from the truth, up to the object's symmetry.
 */
export type PoseErrors = { 
/**
 * |s / s_true − 1|, ≥ 0; 0.05 is 5 %.
 */
scaleError: number, 
/**
 * Angle between the rotations, degrees, 0 to 180; the smallest over the object's symmetries.
 */
rotationErrorDeg: number, 
/**
 * Distance between where the two transforms put the middle of the mesh's box, metres. Not |t − t_true|: t is
 * where the mesh's origin goes, which may lie anywhere. Under the symmetry of the rotation error.
 */
translationErrorM: number, 
/**
 * The same as a share of the object's diameter: the mesh's box diagonal × the true scale.
 */
translationErrorRelative: number, 
/**
 * ADD-S, millimetres: mean distance of the truly posed surface's points to the estimated surface (Hinterstoisser
 * et al. 2012, §4.2, with the exact surface in place of its points).
 */
addSMm: number, };

/**
 * How much went in and how much of it counted. `precise` counts the points of both and the renders, every other method
 * all but the renders; the rest is 0.
 */
export type Counts = { 
/**
 * Source points: of the mesh surface, or of the source cloud.
 */
sourcePoints: number, 
/**
 * Target points: observed, or of the target cloud.
 */
targetPoints: number, 
/**
 * Source points left on the voxel grid.
 */
sourceVoxels: number, 
/**
 * Target points left on the voxel grid.
 */
targetVoxels: number, 
/**
 * Correspondences that went into RANSAC.
 */
matches: number, 
/**
 * Correspondences that agree with the consensus.
 */
inliers: number, 
/**
 * Source points that the target supported in the last iteration of the refinement.
 */
supported: number, 
/**
 * Minimal sets that RANSAC drew.
 */
iterations: number, 
/**
 * Minimal sets dropped by the edge-length check.
 */
inconsistent: number, 
/**
 * Hypotheses dropped because their scale left the guard.
 */
rejected: number, 
/**
 * Hypotheses whose scale was projected back into the guard.
 */
clamped: number, 
/**
 * ICP iterations.
 */
icpIterations: number, 
/**
 * Images that the search drew.
 */
renders: number, };

/**
 * What the search's score is made of: agreements from 0 to 1, on the search's own grid of the cleaned observation.
 */
export type ScoreTerms = { 
/**
 * Of mask and silhouette; what an occluder or the image border hides hardly counts.
 */
overlap: number, 
/**
 * Share of the mask that the mesh covers.
 */
coverage: number, 
/**
 * Of depths, where both have one.
 */
depth: number, 
/**
 * Of normals, where both have one.
 */
normals: number, 
/**
 * Of outlines.
 */
outline: number, 
/**
 * Share of the silhouette that is hidden.
 */
hidden: number, };

/**
 * Another pose that explains the observation, as a transform like the alignment's own.
 */
export type Alternative = { 
/**
 * Its score, to be compared with the alignment's own.
 */
score: number, 
/**
 * The angle between its rotation and the alignment's, in degrees, 0 to 180.
 */
turnDeg: number, 
/**
 * s, target units per source unit; for `align`, metres per mesh unit.
 */
scale: number, 
/**
 * R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF).
 */
rotation: [number, number, number, number], 
/**
 * R as three rows of three.
 */
rotationMatrix: [[number, number, number], [number, number, number], [number, number, number]], 
/**
 * t, in target units; for `align`, metres.
 */
translation: [number, number, number], 
/**
 * The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU).
 */
matrix: [number, number, number, number, number, number, number, number, number, number, number, number, number, number, number, number], };

/**
 * How far the pose could move, to one standard deviation, before the observation would contradict it: what a single
 * view of a symmetric or flat object leaves free is large.
 */
export type Uncertainty = { 
/**
 * Of the scale, as a share of it: 0.01 is one per cent.
 */
scale: number, 
/**
 * Of the rotation about the axis that is determined worst, in degrees.
 */
rotationDeg: number, 
/**
 * That axis: a direction of length 1 in the camera's frame.
 */
rotationAxis: [number, number, number], 
/**
 * Of the position of the mesh's middle across the line of sight, in metres.
 */
lateralM: number, 
/**
 * Of its distance from the camera, in metres.
 */
distanceM: number, };

/**
 * What `align` found: camera from mesh, x_cam = s·R·p + t.
 */
export type Alignment = { 
/**
 * The method that ran.
 */
preset: Preset, 
/**
 * The seed it ran with.
 */
seed: number, 
/**
 * s_init: the ratio of the box diagonals of P_obs and P_rec (§3.1).
 */
initialScale: number, 
/**
 * s / s_init.
 */
scaleRatio: number, 
/**
 * Whether the scale collapsed: scaleRatio below 0.3.
 */
collapsed: boolean, 
/**
 * Whether the scale was projected to a bound of the guard.
 */
clamped: boolean, 
/**
 * Whether the refinement came to rest.
 */
converged: boolean, 
/**
 * Root mean square residual of the refinement, in metres.
 */
residualM: number, 
/**
 * `precise`: how likely the pose is right (scale within 5 %, rotation within 10° up to symmetry, translation
 * within 5 % of the diameter), 0 to 1, calibrated on generated cases; `null` for `paper`.
 */
confidence: number | null, 
/**
 * `precise`: what the search maximised, 0 to about 2, which says how two poses of one input compare and nothing
 * about different inputs. `null` for `paper`.
 */
score: number | null, 
/**
 * `precise`: what the score is made of; `null` for `paper`.
 */
terms: ScoreTerms | null, 
/**
 * `precise`: other poses that explain the observation nearly as well, best first: flips, and symmetries that the
 * object has and the mesh has not. Empty where none comes near, and for `paper`.
 */
alternatives: Array<Alternative>, 
/**
 * `precise`: how well each part of the pose is determined; `null` for `paper`.
 */
uncertainty: Uncertainty | null, 
/**
 * The eight metrics of the pose.
 */
metrics: Metrics, 
/**
 * The counts.
 */
counts: Counts, 
/**
 * Milliseconds by stage, and their total.
 */
timingsMs: Partial<Record<Stage, number>> & { total: number }, 
/**
 * What the caller should know about the input.
 */
warnings: Array<Warning>, 
/**
 * s, target units per source unit; for `align`, metres per mesh unit.
 */
scale: number, 
/**
 * R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF).
 */
rotation: [number, number, number, number], 
/**
 * R as three rows of three.
 */
rotationMatrix: [[number, number, number], [number, number, number], [number, number, number]], 
/**
 * t, in target units; for `align`, metres.
 */
translation: [number, number, number], 
/**
 * The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU).
 */
matrix: [number, number, number, number, number, number, number, number, number, number, number, number, number, number, number, number], };

/**
 * What `evaluate` found.
 */
export type Evaluation = { 
/**
 * The eight metrics of the pose.
 */
metrics: Metrics, 
/**
 * The errors against the truth, where it was given.
 */
errors: PoseErrors | null, 
/**
 * s_init: the ratio of the box diagonals of P_obs and P_rec (§3.1).
 */
initialScale: number, 
/**
 * s / s_init.
 */
scaleRatio: number, 
/**
 * Whether the scale is below 0.3 of the initial one.
 */
collapsed: boolean, 
/**
 * What the caller should know about the input.
 */
warnings: Array<Warning>, };

/**
 * What `register` and `estimateSim3` found: target from source, y = s·R·x + t.
 */
export type Registration = { 
/**
 * The seed it ran with.
 */
seed: number, 
/**
 * The ratio of the clouds' box diagonals, around which a free scale is sought.
 */
initialScale: number, 
/**
 * s / s_init.
 */
scaleRatio: number, 
/**
 * Whether the refinement came to rest; `true` where none was asked for.
 */
converged: boolean, 
/**
 * Root mean square distance of the inliers (or of the refinement's residuals), in target units.
 */
residual: number, 
/**
 * Share of the source points that land within the inlier distance of a target point, 0 to 1; for
 * `estimateSim3`, share of the correspondences that are inliers.
 */
fitness: number, 
/**
 * The counts.
 */
counts: Counts, 
/**
 * Milliseconds by stage, and their total.
 */
timingsMs: Partial<Record<Stage, number>> & { total: number }, 
/**
 * s, target units per source unit; for `align`, metres per mesh unit.
 */
scale: number, 
/**
 * R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF).
 */
rotation: [number, number, number, number], 
/**
 * R as three rows of three.
 */
rotationMatrix: [[number, number, number], [number, number, number], [number, number, number]], 
/**
 * t, in target units; for `align`, metres.
 */
translation: [number, number, number], 
/**
 * The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU).
 */
matrix: [number, number, number, number, number, number, number, number, number, number, number, number, number, number, number, number], };
