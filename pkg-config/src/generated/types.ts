// Generated from the Rust structs by tests/suite/typescript.rs; do not edit.

/**
 * Which method runs.
 */
export type Preset = "paper";

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
 */
export type AlignOptions = { 
/**
 * The method. Default `"paper"`.
 */
preset: Preset, 
/**
 * Seed of all random draws, 0 to 2³² − 1. The same input and seed give the same bits. Default 0.
 */
seed: number, 
/**
 * Depth readings inside the mask that are used at most, 32 to 1 000 000; of more, an even random share is
 * drawn. Default 20 000.
 */
maxObservedPoints: number, 
/**
 * Points sampled from the mesh surface, 100 to 1 000 000. Default 20 000.
 */
surfaceSamples: number, 
/**
 * Voxels along the observation's box diagonal, 5 to 200: the voxel size is the diagonal divided by this
 * (paper: 20, 30, 50). Default 30.
 */
voxelDivisions: number, 
/**
 * Radius of the FPFH descriptors, in voxels, 1 to 20. Default 5.
 */
fpfhRadiusVoxels: number, 
/**
 * Bounds [λmin, λmax] of the scale relative to the initial scale, 0 < λmin ≤ 1 ≤ λmax; `null` lets the
 * scale go anywhere (the ablation). Default [0.5, 1.5].
 */
guard: [number, number] | null, 
/**
 * What happens to hypotheses outside the guard. Default `"reject"`.
 */
guardMode: GuardMode, 
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
 * A match within this distance of its counterpart is an inlier, in voxels, 0.1 to 20. Default 1.5.
 */
inlierDistanceVoxels: number, 
/**
 * How alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1.
 * Default 0.9.
 */
edgeSimilarity: number, 
/**
 * Whether mesh regions that the observation does not support are left out. Default `true`.
 */
hallucinationFilter: boolean, 
/**
 * Support: largest distance to an observed point, in voxels, 0.1 to 50; ICP tightens it to a third as the
 * pose improves. Default 3.
 */
supportDistanceVoxels: number, 
/**
 * Support: largest angle between the two normals, in degrees, 0 to 180. Default 60.
 */
supportAngleDeg: number, 
/**
 * The refinement. Default `"point-to-plane"`.
 */
icp: Icp, 
/**
 * ICP leaves the scale as RANSAC found it (paper §3.3). `false` is the ablation. Default `true`.
 */
lockScale: boolean, 
/**
 * ICP iterations at most, 1 to 1 000. Default 60.
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
 * Points of each cloud that are used at most, 32 to 1 000 000. Default 20 000.
 */
maxPoints: number, 
/**
 * Voxel size in target units, above 0; `null` derives it from `voxelDivisions`. Default `null`.
 */
voxelSize: number | null, 
/**
 * Voxels along the target's box diagonal, 5 to 200. Default 30.
 */
voxelDivisions: number, 
/**
 * Radius of the FPFH descriptors, in voxels, 1 to 20. Default 5.
 */
fpfhRadiusVoxels: number, 
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
 * A match within this distance of its counterpart is an inlier, in voxels, 0.1 to 20. Default 1.5.
 */
inlierDistanceVoxels: number, 
/**
 * How alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1.
 * Default 0.9.
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
export type Stage = "observe" | "sample" | "normals" | "features" | "matching" | "ransac" | "filter" | "icp" | "metrics";

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
 * How much went in and how much of it counted.
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
icpIterations: number, };

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
