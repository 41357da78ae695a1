// Generated from the Rust declarations by lab/tests/suite/typescript.rs; not to be edited.

import type { Direction, ScaleOption, Sim3Like, SymmetryOption } from "../types/argument-types.js";

/** The method of an alignment. */
export type Preset = "precise" | "paper";

/** The outcome of the comparison of colours. */
export type ColorVerdict = "hidden" | "uniform" | "unmatched" | "agreed" | "decided";

/** How much work the search does. */
export type Quality = "auto" | "fast" | "balanced" | "best";

/** The work of one search. */
export type Effort = "fast" | "balanced" | "best";

/** Where the search looks for poses. */
export type SearchScope = "global" | "local";

/** A side of the mesh's bounding box. */
export type ExtentAxis = "longest" | "x" | "y" | "z";

/** What of a mesh's proportions is fitted to the image. */
export type Proportions = "keep" | "axes" | "full";

/** What RANSAC does with a hypothesis whose scale is outside the guard. */
export type GuardMode = "reject" | "clamp";

/** The distance that ICP minimises. */
export type Icp = "point-to-plane" | "point-to-point" | "none";

/** Options of `align` with the default preset, `"precise"`. All have defaults. */
export interface AlignOptions {
  /** The default method: search by rendering. */
  preset?: "precise" | undefined;
  /** How much work a search does. Default `"auto"`. */
  quality?: Quality | undefined;
  /**
   * The scale in metres per mesh unit: `"free"`, a known number (1 for a mesh in metres), or bounds `[min, max]`. Not
   * together with `knownExtentM`. Default `"free"`.
   */
  scale?: ScaleOption | undefined;
  /**
   * The object's known length along `knownExtentAxis`, in metres. It fixes the scale: for a mug that is 9.5 cm tall
   * and whose mesh has y up, pass `{ knownExtentM: 0.095, knownExtentAxis: "y" }`. Takes a finite number above 0, or
   * null. Default `null`.
   */
  knownExtentM?: number | null | undefined;
  /** The side of the mesh's bounding box that `knownExtentM` measures. Default `"longest"`. */
  knownExtentAxis?: ExtentAxis | undefined;
  /**
   * The object's symmetry: poses that it makes equal are one for `confidence`, `alternatives` and `uncertainty`.
   * `"auto"` finds it on the surface of the mesh; `[{ axis: [0, 1, 0], fold: 4 }]` declares quarter turns about the
   * mesh's y axis, without `fold` any turn about it. Default `"auto"`.
   */
  symmetry?: SymmetryOption | undefined;
  /**
   * The up direction in the camera's frame, of any length: `[0, -1, 0]` for a level camera. Together with `meshUp`,
   * it favours poses in which the object stands upright. Default `null`.
   */
  cameraUp?: Direction | null | undefined;
  /**
   * The up direction in the mesh's frame, of any length: `[0, 1, 0]` for glTF. It requires `cameraUp`. Default
   * `null`.
   */
  meshUp?: Direction | null | undefined;
  /**
   * A pose to start from, camera from mesh, in metres: for example an annotator's, or a generator's. Its scale has to
   * be within `scale`. It is one candidate among those of the search; between turns that the image hardly tells
   * apart, the one near its rotation is favoured. Default `null`.
   */
  initial?: Sim3Like | null | undefined;
  /** Where to search: everywhere, or around `initial` only. Default `"global"`. */
  search?: SearchScope | undefined;
  /**
   * An upper bound on the work of the search, in units of about a millisecond on a 2020 laptop. The work is counted,
   * not timed, so that the result does not depend on the machine. `null` sets no bound. Takes a finite number above
   * 0, or null. Default `null`.
   */
  workBudget?: number | null | undefined;
  /**
   * Whether to fit the proportions of the mesh, which generators get wrong by some per cent: see `proportions` of the
   * result. The similarity and its metrics stay those of the mesh as it is. Not of a mesh whose scale is given.
   * Default `"keep"`.
   */
  proportions?: Proportions | undefined;
  /** Whether to compute `metrics`. Without them the call takes less time. Default `true`. */
  metrics?: boolean | undefined;
  /**
   * Upper bound on the depth readings used for metrics and initial scale. Above it, an even random subset is drawn.
   * Takes a whole number from 32 to 1000000. Default `20000`.
   */
  maxObservedPoints?: number | undefined;
  /**
   * Number of points sampled on the mesh surface for metrics and initial scale. Takes a whole number from 100 to
   * 1000000. Default `10000`.
   */
  surfaceSamples?: number | undefined;
  /**
   * Seed of all random draws. The same input and seed give the same bits. Takes a whole number from 0 to 4294967295.
   * Default `0`.
   */
  seed?: number | undefined;
}

/** Options of `align` with `preset: "paper"`: the method of the paper, for comparison. All others have defaults. */
export interface PaperOptions extends Pick<AlignOptions, "seed" | "metrics"> {
  /** The paper's method. */
  preset: "paper";
  /**
   * Upper bound on the depth readings used. Above it, an even random subset is drawn. Takes a whole number from 32 to
   * 1000000. Default `20000`.
   */
  maxObservedPoints?: number | undefined;
  /** Number of points sampled on the mesh surface. Takes a whole number from 100 to 1000000. Default `20000`. */
  surfaceSamples?: number | undefined;
  /**
   * Voxels along the diagonal of the observation's bounding box (the paper compares 20, 30 and 50). Takes a number
   * from 5 to 200. Default `30`.
   */
  voxelDivisions?: number | undefined;
  /** Radius of the FPFH descriptors, in voxels. Takes a number from 1 to 20. Default `5`. */
  fpfhRadiusVoxels?: number | undefined;
  /**
   * Bounds [λmin, λmax] of the scale relative to the initial scale. `null` leaves the scale unbounded, which is an
   * ablation of the paper. Takes [min, max] with 0 < min ≤ 1 ≤ max, or null. Default `[0.5,1.5]`.
   */
  guard?: readonly [min: number, max: number] | null | undefined;
  /** What RANSAC does with a hypothesis whose scale is outside the guard. Default `"reject"`. */
  guardMode?: GuardMode | undefined;
  /** Upper bound on the minimal sets that RANSAC draws. Takes a whole number from 1 to 10000000. Default `100000`. */
  ransacIterations?: number | undefined;
  /**
   * RANSAC stops once it has found the best consensus with this probability. Takes a number from 0 to 0.999999.
   * Default `0.999`.
   */
  ransacConfidence?: number | undefined;
  /** Distance below which a match counts as an inlier, in voxels. Takes a number from 0.1 to 20. Default `1.5`. */
  inlierDistanceVoxels?: number | undefined;
  /**
   * Smallest accepted ratio between the stretches of a minimal set's three edges, least to most stretched. Takes a
   * number from 0 to 1. Default `0.9`.
   */
  edgeSimilarity?: number | undefined;
  /** Whether mesh regions without support by the observation are left out. Default `true`. */
  hallucinationFilter?: boolean | undefined;
  /**
   * Largest distance to an observed point that counts as support, in voxels. ICP tightens it to a third as the pose
   * improves. Takes a number from 0.1 to 50. Default `3`.
   */
  supportDistanceVoxels?: number | undefined;
  /**
   * Largest angle between the two normals that counts as support, in degrees. Takes a number from 0 to 180. Default
   * `60`.
   */
  supportAngleDeg?: number | undefined;
  /** The distance that ICP minimises, or `"none"` for no refinement. Default `"point-to-plane"`. */
  icp?: Icp | undefined;
  /** Whether ICP leaves the scale as RANSAC found it (§3.3). `false` is an ablation of the paper. Default `true`. */
  lockScale?: boolean | undefined;
  /**
   * Upper bound on the iterations of each of ICP's two passes: on the voxel grid, then on the points. Takes a whole
   * number from 1 to 1000. Default `60`.
   */
  icpIterations?: number | undefined;
}

/** Options of `alignViews`. All have defaults. */
export interface ViewsOptions
  extends Pick<AlignOptions, "quality" | "scale" | "knownExtentM" | "knownExtentAxis" | "symmetry" | "seed"> {
  /**
   * Whether to fit the proportions of the mesh to all views together, as in `align`. Only with given camera poses.
   * Default `"keep"`.
   */
  proportions?: Proportions | undefined;
  /** Whether to compute the `metrics` of each view. Without them the call takes less time. Default `true`. */
  metrics?: boolean | undefined;
  /**
   * Upper bound on the depth readings of each view that are used for metrics. Takes a whole number from 32 to
   * 1000000. Default `20000`.
   */
  maxObservedPoints?: number | undefined;
  /**
   * Number of points sampled on the mesh surface for metrics. Takes a whole number from 100 to 1000000. Default
   * `10000`.
   */
  surfaceSamples?: number | undefined;
}

/** Options of `track`. All have defaults. */
export interface TrackOptions
  extends Pick<AlignOptions, "quality" | "scale" | "knownExtentM" | "knownExtentAxis" | "symmetry" | "seed"> {
  /**
   * The pose in the first frame, camera from mesh, in metres, if it is known. That frame then needs no mask. Default
   * `null`.
   */
  initial?: Sim3Like | null | undefined;
  /**
   * Whether to compute `metrics` of each frame that has a mask, which takes several times as long as tracking.
   * Default `false`.
   */
  metrics?: boolean | undefined;
}

/** Options of `evaluate`. All have defaults. */
export interface EvaluateOptions extends Pick<AlignOptions, "seed">, Pick<PaperOptions, "maxObservedPoints"> {
  /** The known transform, camera from mesh, that `errors` compares with. Default `null`. */
  truth?: Sim3Like | null | undefined;
  /**
   * The object's symmetry: the rotation error is the smallest over it. `"auto"` finds it on the surface of the mesh,
   * once for all calls with the mesh. Default `"auto"`.
   */
  symmetry?: SymmetryOption | undefined;
  /** Number of points sampled on the mesh surface. Takes a whole number from 100 to 1000000. Default `10000`. */
  surfaceSamples?: number | undefined;
  /**
   * Number of points, evenly spread over those of each side, from which distances and normals are measured. By
   * default, the means are within about half a per cent of those from all: 1 000 000 measures from every point. Takes
   * a whole number from 32 to 1000000. Default `1024`.
   */
  measuredPoints?: number | undefined;
}

/** Options of `register`. All have defaults. */
export interface RegisterOptions
  extends Pick<AlignOptions, "seed">,
    Pick<PaperOptions, "fpfhRadiusVoxels" | "inlierDistanceVoxels" | "icp" | "icpIterations"> {
  /**
   * The scale in target units per source unit: `"free"`, a known number (1 for rigid registration), or bounds `[min,
   * max]`. Default `"free"`.
   */
  scale?: ScaleOption | undefined;
  /**
   * Upper bound on the points used of each cloud. Above it, a random subset is drawn or, with a known scale, small
   * voxels are averaged. Takes a whole number from 32 to 1000000. Default `20000`.
   */
  maxPoints?: number | undefined;
  /**
   * Voxel size in target units. `null` derives it from `voxelDivisions`. Takes a finite number above 0, or null.
   * Default `null`.
   */
  voxelSize?: number | null | undefined;
  /**
   * Voxels along the diagonal of the target's bounding box. `null` takes 30 or, with a known scale, the size that
   * leaves 5000 points of the larger cloud. Takes a number from 5 to 200, or null. Default `null`.
   */
  voxelDivisions?: number | null | undefined;
  /**
   * Upper bound on the minimal sets that RANSAC draws. With a known scale, which needs no draws, it bounds the poses
   * that are tried, which are 100 at most. Takes a whole number from 1 to 10000000. Default `100000`.
   */
  ransacIterations?: number | undefined;
  /**
   * RANSAC stops once it has found the best consensus with this probability. Without effect with a known scale. Takes
   * a number from 0 to 0.999999. Default `0.999`.
   */
  ransacConfidence?: number | undefined;
  /**
   * Smallest accepted ratio between the stretches of a minimal set's three edges, least to most stretched. Without
   * effect with a known scale. Takes a number from 0 to 1. Default `0.9`.
   */
  edgeSimilarity?: number | undefined;
  /**
   * An upper bound on the work, in units of about a millisecond on a 2020 laptop. The work is counted, not timed.
   * Draws and poses beyond it are left out; preparing the clouds takes what their points need. `null` sets no bound.
   * Takes a finite number above 0, or null. Default `null`.
   */
  workBudget?: number | null | undefined;
}

/** Options of `estimateSim3`. All have defaults. */
export interface EstimateSim3Options
  extends Pick<AlignOptions, "seed">,
    Pick<PaperOptions, "ransacIterations" | "ransacConfidence" | "edgeSimilarity"> {
  /**
   * The scale in target units per source unit: `"free"`, a known number (1 for a rigid transform), or bounds `[min,
   * max]`. Default `"free"`.
   */
  scale?: ScaleOption | undefined;
  /**
   * Distance below which a correspondence counts as an inlier, in target units. `null` takes a twentieth of the
   * diagonal of the target's bounding box. Takes a finite number above 0, or null. Default `null`.
   */
  inlierDistance?: number | null | undefined;
  /**
   * An upper bound on the work, in units of about a millisecond on a 2020 laptop. The work is counted, not timed.
   * Draws beyond it are left out. `null` sets no bound. Takes a finite number above 0, or null. Default `null`.
   */
  workBudget?: number | null | undefined;
}

/** A stage of the pipeline. */
export type Stage = "observe" | "sample" | "normals" | "features" | "matching" | "ransac" | "filter" | "icp" | "inspect" | "prepare" | "search" | "refine" | "metrics";

/** Milliseconds per stage, in the order in which the stages first ran, and their total. */
export type Timings = Partial<Record<Stage, number>> & { total: number };

/**
 * Stable error code; does not change between releases.
 *
 * In JavaScript it is the `code` of a `Sim3AlignError`, spelled as [`ErrorCode::as_str`] spells it.
 */
export type ErrorCode = "INVALID_ARGUMENT" | "INVALID_OPTION" | "UNKNOWN_OPTION" | "WRONG_LENGTH" | "EMPTY_IMAGE" | "SIZE_MISMATCH" | "INVALID_CAMERA" | "EMPTY_MASK" | "DEGENERATE_MASK" | "NO_DEPTH_IN_MASK" | "FLAT_DEPTH" | "TOO_FEW_POINTS" | "EMPTY_MESH" | "INDEX_OUT_OF_RANGE" | "NON_FINITE" | "DEGENERATE_MESH" | "DEGENERATE_POINTS" | "NO_CONSENSUS" | "INVALID_TRANSFORM" | "UNSUPPORTED_FORMAT" | "CORRUPT_FILE" | "FILE_TOO_LARGE" | "EIGHT_BIT_DEPTH" | "COMPRESSED_MESH" | "OUT_OF_MEMORY" | "TRACKER_LOST" | "INTERNAL";

/** The kinds of warning. */
export type WarningCode = "DEPTH_LOOKS_LIKE_MILLIMETRES" | "DEPTH_LOOKS_TOO_SMALL" | "DEPTH_LOOKS_INVERTED" | "DEPTH_LOOKS_LIKE_BACKGROUND" | "DEPTH_LOOKS_NORMALISED" | "DEPTH_LOOKS_CODED" | "DEPTH_HAS_SPECKLE" | "MASK_COVERS_IMAGE" | "MASK_LOOKS_INVERTED" | "MASK_HAS_LABELS" | "MASK_TOUCHES_BORDER" | "SPARSE_DEPTH" | "SCALE_CLAMPED" | "SCALE_COLLAPSED" | "NOT_CONVERGED" | "MESH_DOUBTFUL" | "MESH_LOOKS_MIRRORED" | "MESH_HOLDS_COPIES" | "TEXTURE_LOOKS_FLIPPED" | "MESH_PARTS_LEFT_OUT" | "VIEW_CONTRADICTS" | "VIEW_SHOWS_NOTHING" | "CAMERA_NOT_PINHOLE" | "CAMERA_DOUBTFUL" | "SIZE_DOUBTFUL" | "FOCAL_LENGTH_UNKNOWN" | "CONTENT_NOT_READ" | "COLORS_NOT_READ";

/** A condition that the caller should know about; the result stands. */
export type Warning = {
  /** The kind of warning, stable across releases. */
  code: WarningCode;
  /** The fault and its remedy. */
  message: string;
};

/** A similarity y = s·R·x + t in the forms that applications use. */
export type Sim3 = {
  /** s, target units per source unit; for `align`, metres per mesh unit. */
  scale: number;
  /** R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF). */
  rotation: [number, number, number, number];
  /** R as three rows of three. */
  rotationMatrix: [[number, number, number], [number, number, number], [number, number, number]];
  /** t, in target units; for `align`, metres. */
  translation: [number, number, number];
  /** The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU). */
  matrix: number[];
};

/**
 * Agreement of a posed mesh with the observation. `null` marks a value that could not be measured. Distances to a
 * mesh with more than 262 144 triangles are distances to its decimated surface, which differs by less than a
 * thousandth of its size.
 */
export type Metrics = {
  /**
   * DAVIS boundary F-measure of mask and rendered silhouette at 0.008 × the image diagonal, 0 to 1, higher is better;
   * 0 if nothing is rendered.
   */
  boundaryF: number | null;
  /** Distance of the centroids of mask and rendered silhouette, pixels; `null` where nothing is rendered. */
  centerDriftPx: number | null;
  /**
   * Intersection over union of mask and rendered silhouette, 0 to 1, higher is better; 0 where nothing is rendered or
   * nothing overlaps.
   */
  iou: number | null;
  /**
   * Mean of the two directional mean distances between observed points and surface, metres. The surface's unseen side
   * counts, so that it is above 0 at the true pose too.
   */
  chamferM: number | null;
  /** Mean distance from the observed points to the surface, metres. */
  uniChamferM: number | null;
  /** Share of the observed points within 5 % of their box diagonal of the surface, 0 to 1. */
  fitness: number | null;
  /**
   * Mean |n·n′| of an observed point's normal and that of the nearest triangle, 0 to 1; random directions give 0.5.
   * `null` where no point has a normal.
   */
  normalConsistency: number | null;
  /** Mean |rendered − observed| depth over the mask's pixels that have both, metres; `null` where none has. */
  depthMaeM: number | null;
  /**
   * Correlation of the mesh's colours with the photo inside the mask, without the shading that normals explain, −1 to
   * 1, higher is better; absent where the mesh or the photo has no colours. Not of the paper.
   */
  colorAgreement?: number;
};

/** Errors of an estimate relative to the true pose, up to the symmetry of the object. */
export type PoseErrors = {
  /** |s / s_true − 1|, ≥ 0; 0.05 is 5 %. */
  scaleError: number;
  /** Angle between the rotations, degrees, 0 to 180; the smallest over the symmetries of the object. */
  rotationErrorDeg: number;
  /**
   * Distance between the centres of the mesh's bounding box under both transforms, metres. Unlike |t − t_true|, it
   * does not depend on the origin of the mesh. Uses the symmetry of the rotation error.
   */
  translationErrorM: number;
  /**
   * The translation error relative to the diameter of the object: the diagonal of the mesh's bounding box × the true
   * scale.
   */
  translationErrorRelative: number;
  /**
   * ADD-S, metres: mean distance of surface points under the true pose to the surface under the estimated pose
   * (Hinterstoisser et al. 2012, §4.2, with the exact surface instead of its points).
   */
  addSM: number;
};

/** Sizes of the problem and of the search. */
export type SearchCounts = {
  /** Source points, of the mesh surface. */
  sourcePoints: number;
  /** Target points, observed. */
  targetPoints: number;
  /** Images that the search drew. */
  renders: number;
};

/**
 * Sizes of the problem and events during the run. `precise` counts points and renders, the other methods everything
 * but renders; what a method does not count is 0.
 */
export type Counts = {
  /** Source points: of the mesh surface, or of the source cloud. */
  sourcePoints: number;
  /** Target points: observed, or of the target cloud. */
  targetPoints: number;
  /** Source points left on the voxel grid. */
  sourceVoxels: number;
  /** Target points left on the voxel grid. */
  targetVoxels: number;
  /** Correspondences that went into RANSAC. */
  matches: number;
  /** Correspondences that agree with the consensus. */
  inliers: number;
  /** Source points that the target supported in the last iteration of the refinement. */
  supported: number;
  /** Minimal sets that RANSAC drew. */
  iterations: number;
  /** Minimal sets dropped by the edge-length check. */
  inconsistent: number;
  /** Hypotheses dropped because their scale left the guard. */
  rejected: number;
  /** Hypotheses whose scale was projected back into the guard. */
  clamped: number;
  /** ICP iterations. */
  icpIterations: number;
};

/**
 * The terms of the search's score: agreements from 0 to 1, measured on the search's own grid of the cleaned
 * observation.
 */
export type ScoreTerms = {
  /** Overlap of mask and silhouette; parts hidden by an occluder or by the image border hardly count. */
  overlap: number;
  /** Share of the mask that the mesh covers. */
  coverage: number;
  /** Agreement of the depths, where both have one. */
  depth: number;
  /** Agreement of the normals, where both have one. */
  normals: number;
  /** Agreement of the outlines. */
  outline: number;
  /** Share of the silhouette that is hidden. */
  hidden: number;
};

/** The part of the colours of photo and mesh in an alignment. */
export type ColorReport = {
  /** The outcome of the comparison. */
  verdict: ColorVerdict;
  /**
   * Correlation of the colours of mesh and photo at the resulting pose, without the shading that normals explain, −1
   * to 1.
   */
  agreement: number;
  /**
   * Lead over the next pose that shape allows and that looks different, in units of the correlation; `null` where
   * there is none.
   */
  margin: number | null;
};

/** Another pose that explains the observation: a transform like the alignment's own. */
export type Alternative = Sim3 & {
  /** Its score, which compares with the alignment's `diagnostics.score`. */
  score: number;
  /** The angle between its rotation and the alignment's, in degrees, 0 to 180. */
  turnDeg: number;
  /**
   * The correlation of the alignment's colours with the photo, minus that of this pose; present where colours were
   * compared.
   */
  colorMargin?: number;
};

/** An axis of a symmetry of the shape, in the form that the option `symmetry` takes. */
export type FoundSymmetry = {
  /** The axis in the mesh's frame, through the centroid of the surface. */
  axis: [number, number, number];
  /** The number of equivalent positions in a full rotation; missing for a surface of revolution. */
  fold?: number;
};

/**
 * Standard deviations of the pose's parts, as the observation determines them. Parts that a single view leaves open
 * have large ones.
 */
export type Uncertainty = {
  /** Of the scale, relative: 0.01 is one per cent. */
  scale: number;
  /** Of the rotation about the least determined axis, in degrees, up to the symmetry of the mesh. */
  rotationDeg: number;
  /** That axis: a unit vector in the camera's frame. */
  rotationAxis: [number, number, number];
  /**
   * The axis of revolution of the mesh, a unit vector in the camera's frame: any turn about it leaves its shape as it
   * is, and does not count as uncertain. `null` if it has none.
   */
  freeAxis: [number, number, number] | null;
  /** Of the mesh centre's position across the line of sight, in metres. */
  lateralM: number;
  /** Of the mesh centre's distance from the camera, in metres. */
  distanceM: number;
};

/**
 * A mesh in the proportions that the image shows: x_cam = s·R·S·p_mesh + t. The image determines less of them the
 * less it shows of a side; what it does not show stays as the mesh has it, and is uncertain.
 */
export type Stretch = Sim3 & {
  /** S as three rows of three: symmetric, of determinant 1, in the frame of the mesh. */
  stretch: [[number, number, number], [number, number, number], [number, number, number]];
  /** Lengths of the box around the stretched mesh along x, y and z of its frame, in metres. */
  sizeM: [number, number, number];
  /** Standard deviations of the lengths along x, y and z of the mesh, relative: 0.01 is one per cent. */
  uncertainty: [number, number, number];
};

/** How an evaluated scale compares with the initial one. */
export type EvaluationDiagnostics = {
  /** s_init: the ratio of the bounding boxes' diagonals, observation to mesh (§3.1). */
  initialScale: number;
  /** The scale divided by the initial scale. */
  scaleRatio: number;
  /** Whether the scale collapsed: `scaleRatio` is below 0.3. */
  collapsed: boolean;
};

/** The report of all presets besides the pose. */
export type Diagnostics = EvaluationDiagnostics & {
  /** The method that ran. */
  preset: Preset;
  /** The seed it ran with. */
  seed: number;
  /** Whether the scale was held at a bound. */
  clamped: boolean;
  /** Whether the refinement converged. */
  converged: boolean;
  /** Root mean square residual of the refinement, in metres. */
  residualM: number;
  /** Milliseconds per stage, and their total. */
  timingsMs: Timings;
};

/** Diagnostics of the preset `paper`. */
export type PaperDiagnostics = Diagnostics & {
  /** Sizes of the problem and events during the run. */
  counts: Counts;
};

/** Diagnostics of the preset `precise`. */
export type PreciseDiagnostics = Diagnostics & {
  /** Sizes of the problem and of the search. */
  counts: SearchCounts;
  /** The effort of the search that found the pose; it follows from `quality`. */
  effort: Effort;
  /**
   * The search's objective, 0 to about 2. It compares poses of one input; scores of different inputs do not compare.
   * Unless the scale is fixed, it is that of the mesh in the proportions that fit the image best.
   */
  score: number;
  /** The terms of the score. */
  terms: ScoreTerms;
  /** What colour contributed; present where photo and mesh have colours. */
  color?: ColorReport;
};

/**
 * The result of `align` with `preset: "paper"`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y
 * down, z forward; metres).
 */
export type PaperAlignment = Sim3 & {
  /** Agreement of the posed mesh with the observation. */
  metrics: Metrics;
  /** Conditions that the caller should know about; the result stands. */
  warnings: Array<Warning>;
  /** Everything else: initial scale, counts, timings. */
  diagnostics: PaperDiagnostics;
};

/**
 * The result of `align`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y down, z forward;
 * metres).
 */
export type Alignment = Sim3 & {
  /**
   * Probability that the pose is right in everything that the input shows: `shapeConfidence` times `turnConfidence`,
   * where that is not `null`. It assumes that the mesh is the object's.
   */
  confidence: number;
  /**
   * Probability that the pose is right up to the symmetry of the shape (scale within 5 %, rotation within 10°,
   * translation within 5 % of the diameter), calibrated on generated cases.
   */
  shapeConfidence: number;
  /**
   * Probability that the turn is right: that of the poses which a symmetry of the shape makes equal, this is the one
   * whose colours are those of the photo. `null` where no other turn is possible: the shape has no symmetry, its
   * turns look alike, or there are no colours to compare. Where no turn agrees with the photo, or the colours of the
   * mesh could not be read, all are equally likely.
   */
  turnConfidence: number | null;
  /**
   * The symmetry of the shape by which poses counted as one: that of the option, or what was found on the mesh. Empty
   * without one.
   */
  symmetry: Array<FoundSymmetry>;
  /**
   * Other poses that explain the observation nearly as well, best first. Poses that the symmetry of the shape makes
   * equal are one, unless their colours differ.
   */
  alternatives: Array<Alternative>;
  /** How well the observation determines each part of the pose; `null` where it is unknown. */
  uncertainty: Uncertainty | null;
  /** The mesh in its true proportions; present where they were asked for, and fitted. */
  proportions?: Stretch;
  /** Agreement of the posed mesh with the observation. */
  metrics: Metrics;
  /** Conditions that the caller should know about; the result stands. */
  warnings: Array<Warning>;
  /** Everything else: initial scale, score, counts, timings. */
  diagnostics: PreciseDiagnostics;
};

/** The world of a result. */
export type WorldFrame = "given" | "camera";

/** The part of a view in the result. */
export type ViewRole = "used" | "contradicting" | "unusable";

/** Standard deviations of the pose in the world, as all views together determine them. */
export type WorldUncertainty = {
  /** Of the scale, relative: 0.01 is one per cent. */
  scale: number;
  /** Of the rotation about the least determined axis, in degrees, up to the symmetry of the mesh. */
  rotationDeg: number;
  /** That axis: a unit vector in the world frame. */
  rotationAxis: [number, number, number];
  /**
   * The axis of revolution of the mesh, a unit vector in the world frame: any turn about it leaves its shape as it
   * is, and does not count as uncertain. `null` if it has none.
   */
  freeAxis: [number, number, number] | null;
  /** Of the mesh centre's position along the least determined direction, in metres. */
  positionM: number;
};

/** The pose of a camera in the world. */
export type CameraPose = Sim3 & {
  /**
   * Standard deviation of its rotation, in degrees; 0 for given camera poses and for the camera that is the world,
   * `null` where the views do not determine it.
   */
  rotationSdDeg: number | null;
  /** Standard deviation of its position, in metres; 0 and `null` as above. */
  positionSdM: number | null;
};

/** The object in one of the views. */
export type ViewPose = Sim3 & {
  /** Probability that this pose is right; see `Alignment.confidence`. */
  confidence: number;
  /** The part of the view in the result. */
  role: ViewRole;
  /** The pose of its camera. */
  camera: CameraPose;
  /** The score of the pose in this view; it compares with that of `align` for the same view. */
  score: number;
  /** The terms of the score. */
  terms: ScoreTerms;
  /**
   * What the colours of photo and mesh contributed; with given camera poses, those of all views together. Present
   * where the view has a photo and the mesh has colours.
   */
  color?: ColorReport;
  /** Agreement of the posed mesh with the view. */
  metrics: Metrics;
  /** Conditions of this view that the caller should know about. */
  warnings: Array<Warning>;
};

/** Diagnostics of `alignViews`. */
export type ViewsDiagnostics = {
  /** The seed it ran with. */
  seed: number;
  /** The effort of the searches that found the pose. */
  effort: Effort;
  /** The sum of the scores of all views. */
  score: number;
  /** Whether the refinement converged. */
  converged: boolean;
  /** Images that the searches drew. */
  renders: number;
  /** Milliseconds per stage, and their total. */
  timingsMs: Timings;
};

/** The result of `alignViews`: world from mesh, x_world = s·R·p_mesh + t, in metres. */
export type ViewsAlignment = Sim3 & {
  /** The world. */
  world: WorldFrame;
  /**
   * Probability that the pose is right; see `Alignment.confidence`. Without given camera poses, that of the least
   * certain view.
   */
  confidence: number;
  /** The same up to the symmetry of the shape; see `Alignment.shapeConfidence`. */
  shapeConfidence: number;
  /** The probability of the turn; see `Alignment.turnConfidence`. */
  turnConfidence: number | null;
  /**
   * The symmetry of the shape by which poses counted as one: that of the option, or what was found on the mesh. Empty
   * without one.
   */
  symmetry: Array<FoundSymmetry>;
  /**
   * Other poses that explain all views nearly as well, world from mesh, best first. Empty without given camera poses.
   */
  alternatives: Array<Alternative>;
  /** How well the views together determine the pose; `null` where they do not. */
  uncertainty: WorldUncertainty | null;
  /** The mesh in its true proportions, world from stretched mesh; present where they were asked for, and fitted. */
  proportions?: Stretch;
  /** The object in each view, in the order of the input. */
  views: Array<ViewPose>;
  /** Conditions that the caller should know about; the result stands. */
  warnings: Array<Warning>;
  /** Everything else. */
  diagnostics: ViewsDiagnostics;
};

/** The state of a tracker after a frame. */
export type TrackState = "tracking" | "uncertain" | "lost";

/** The pose of a frame after a correction of another one. */
export type CorrectedFrame = Sim3 & {
  /** The number of the frame. */
  frame: number;
};

/**
 * The pose in a frame: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y down, z forward; metres).
 */
export type TrackedFrame = Sim3 & {
  /** The number of the frame: 0 for the first. */
  frame: number;
  /** The state of the tracker. */
  state: TrackState;
  /** Probability that the pose is right; see `Alignment.confidence`. 0 while the object is lost. */
  confidence: number;
  /** The same up to the symmetry of the shape; see `Alignment.shapeConfidence`. */
  shapeConfidence: number;
  /**
   * The probability of the turn in which the object was found, which is kept while it is tracked; see
   * `Alignment.turnConfidence`.
   */
  turnConfidence: number | null;
  /** The symmetry of the shape; see `Alignment.symmetry`. */
  symmetry: Array<FoundSymmetry>;
  /**
   * Standard deviation of the size, relative: 0.01 is one per cent. It includes errors that all frames share. 0 for a
   * given scale.
   */
  scaleSd: number;
  /** Whether the size is settled: later frames keep it. */
  isScaleSettled: boolean;
  /** Whether the pose was searched for anew, without the frame before. */
  isDetected: boolean;
  /** The score of the pose, as of `align`. */
  score: number;
  /** The terms of the score. */
  terms: ScoreTerms;
  /** Agreement of the posed mesh with the frame, if it was asked for and the frame has a mask. */
  metrics: Metrics | null;
};

/** The result of `evaluate`. */
export type Evaluation = {
  /** Agreement of the posed mesh with the observation. */
  metrics: Metrics;
  /** The errors against the truth; `null` where no truth was given. */
  errors: PoseErrors | null;
  /** Conditions that the caller should know about; the result stands. */
  warnings: Array<Warning>;
  /** How the scale compares with the initial one. */
  diagnostics: EvaluationDiagnostics;
};

/** The support of an object, and the volume that it shares with others. */
export type Contact = {
  /**
   * Its support: `"support"`, the index of another object, `"level"` for a level surface at another height that the
   * depth map shows, such as a shelf or a box without a mesh, or `null` if it touches none of them.
   */
  restsOn: "support" | "level" | number | null;
  /**
   * Height of its lowest point over what is below it, in metres; negative where it enters it. `null` without a
   * support.
   */
  gapM: number | null;
  /** Share of its volume that is inside other objects, 0 to 1. */
  sharedVolume: number;
  /** How far `snap` has moved it along the normal of the support, in metres. */
  snappedM: number;
};

/** Diagnostics of `register` and `estimateSim3`. */
export type RegistrationDiagnostics = {
  /** The seed it ran with. */
  seed: number;
  /** The ratio of the bounding boxes' diagonals, target to source, around which a free scale is sought. */
  initialScale: number;
  /** The scale divided by the initial scale. */
  scaleRatio: number;
  /** Whether the refinement converged; `true` where there was none. */
  converged: boolean;
  /** Number of source points that `register` skipped, because a coordinate is NaN or infinite. */
  skippedSourcePoints: number;
  /** Number of target points that `register` skipped. */
  skippedTargetPoints: number;
  /** Sizes of the problem and events during the run. */
  counts: Counts;
  /** Milliseconds per stage, and their total. */
  timingsMs: Timings;
};

/** The result of `register` and `estimateSim3`: target from source, y = s·R·x + t. */
export type Registration = Sim3 & {
  /**
   * Share of the source points that land within the inlier distance of a target point, 0 to 1; for `estimateSim3`,
   * the share of the correspondences that are inliers.
   */
  fitness: number;
  /** Root mean square distance of the inliers (or residual of the refinement), in target units. */
  residual: number;
  /** Everything else: initial scale, counts, timings. */
  diagnostics: RegistrationDiagnostics;
};

/** Standard deviations of what was estimated; 0 for what was known. */
export type CalibrationUncertainty = {
  /** Of the distance of the objects that the shift leaves, relative to it: 0.01 is one per cent. */
  shift: number;
  /** Of the focal length, relative to it. */
  focal: number;
};

/**
 * What a depth map and its lens were taken to be. With d for a value of the depth map, the depth z is s·d for metric
 * and scale-invariant depth, s·(d + t) for affine-invariant depth, s / (d + t) for affine-invariant disparity.
 */
export type DepthCalibration = {
  /** The kind of the values. */
  depthKind: "metric" | "scale-invariant" | "affine-invariant" | "affine-invariant-disparity";
  /**
   * Whether z is in metres: the depth is, or a known length of an object has made it so. Otherwise, all lengths of
   * the result are in a unit of their own: that of the values of scale-invariant depth, else the distance of the
   * objects.
   */
  isMetric: boolean;
  /** s. */
  scale: number;
  /** t, in the unit of the values. */
  shift: number;
  /** The intrinsics, in pixels of the depth map. */
  camera: { fx: number; fy: number; cx: number; cy: number };
  /** Whether the focal length was estimated. */
  isFocalEstimated: boolean;
  /** How well these numbers are determined. */
  uncertainty: CalibrationUncertainty;
};
