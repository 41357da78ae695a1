// Generated from the Rust declarations by lab/tests/suite/typescript.rs; not to be edited.

import type { OptionRow } from "../types/options.js";

const cameraUp = { name: "cameraUp", kind: "direction", isNullable: true, default: null, summary: "The up direction in the camera's frame, of any length: `[0, -1, 0]` for a level camera" } as const;
const edgeSimilarity = { name: "edgeSimilarity", kind: "number", min: 0, max: 1, isNullable: false, default: 0.9, summary: "Smallest accepted ratio between the stretches of a minimal set's three edges, least to most stretched" } as const;
const fpfhRadiusVoxels = { name: "fpfhRadiusVoxels", kind: "number", min: 1, max: 20, isNullable: false, default: 5, summary: "Radius of the FPFH descriptors, in voxels" } as const;
const icp = { name: "icp", kind: "choice", choices: ["point-to-plane", "point-to-point", "none"], isNullable: false, default: "point-to-plane", summary: "The distance that ICP minimises, or `\"none\"` for no refinement" } as const;
const icpIterations = { name: "icpIterations", kind: "integer", min: 1, max: 1000, isNullable: false, default: 60, summary: "Upper bound on the iterations of each of ICP's two passes: on the voxel grid, then on the points" } as const;
const initial = { name: "initial", kind: "transform", isNullable: true, default: null, summary: "A pose to start from, camera from mesh, in metres: for example an annotator's, or a generator's" } as const;
const inlierDistanceVoxels = { name: "inlierDistanceVoxels", kind: "number", min: 0.1, max: 20, isNullable: false, default: 1.5, summary: "Distance below which a match counts as an inlier, in voxels" } as const;
const knownExtentAxis = { name: "knownExtentAxis", kind: "choice", choices: ["longest", "x", "y", "z"], isNullable: false, default: "longest", summary: "The side of the mesh's bounding box that `knownExtentM` measures" } as const;
const knownExtentM = { name: "knownExtentM", kind: "number", above: 0, isNullable: true, default: null, summary: "The object's known length along `knownExtentAxis`, in metres" } as const;
const maxObservedPoints = { name: "maxObservedPoints", kind: "integer", min: 32, max: 1000000, isNullable: false, default: 20000, summary: "Upper bound on the depth readings used for metrics and initial scale" } as const;
const meshUp = { name: "meshUp", kind: "direction", isNullable: true, default: null, summary: "The up direction in the mesh's frame, of any length: `[0, 1, 0]` for glTF" } as const;
const metrics = { name: "metrics", kind: "boolean", isNullable: false, default: true, summary: "Whether to compute `metrics`" } as const;
const proportions = { name: "proportions", kind: "choice", choices: ["keep", "axes", "full"], isNullable: false, default: "keep", summary: "Whether to fit the proportions of the mesh, which generators get wrong by some per cent: see `proportions` of the result" } as const;
const quality = { name: "quality", kind: "choice", choices: ["auto", "fast", "balanced", "best"], isNullable: false, default: "auto", summary: "How much work a search does" } as const;
const ransacConfidence = { name: "ransacConfidence", kind: "number", min: 0, max: 0.999999, isNullable: false, default: 0.999, summary: "RANSAC stops once it has found the best consensus with this probability" } as const;
const ransacIterations = { name: "ransacIterations", kind: "integer", min: 1, max: 10000000, isNullable: false, default: 100000, summary: "Upper bound on the minimal sets that RANSAC draws" } as const;
const scale = { name: "scale", kind: "scale", isNullable: false, default: "free", summary: "The scale in metres per mesh unit: `\"free\"`, a known number (1 for a mesh in metres), or bounds `[min, max]`" } as const;
const search = { name: "search", kind: "choice", choices: ["global", "local"], isNullable: false, default: "global", summary: "Where to search: everywhere, or around `initial` only" } as const;
const seed = { name: "seed", kind: "integer", min: 0, max: 4294967295, isNullable: false, default: 0, summary: "Seed of all random draws" } as const;
const surfaceSamples = { name: "surfaceSamples", kind: "integer", min: 100, max: 1000000, isNullable: false, default: 10000, summary: "Number of points sampled on the mesh surface for metrics and initial scale" } as const;
const symmetry = { name: "symmetry", kind: "symmetry", isNullable: false, default: "auto", summary: "The object's symmetry: poses that it makes equal are one for `confidence`, `alternatives` and `uncertainty`" } as const;
const voxelDivisions = { name: "voxelDivisions", kind: "number", min: 5, max: 200, isNullable: false, default: 30, summary: "Voxels along the diagonal of the observation's bounding box (the paper compares 20, 30 and 50)" } as const;
const workBudget = { name: "workBudget", kind: "number", above: 0, isNullable: true, default: null, summary: "An upper bound on the work of the search, in units of about a millisecond on a 2020 laptop" } as const;

/** Every option of every call, with its kind, range, default and a one-line description. */
export const OPTIONS: Readonly<Record<"align" | "paper" | "alignScene" | "alignViews" | "track" | "evaluate" | "register" | "estimateSim3", readonly OptionRow[]>> = /* @__PURE__ */ (() => ({
  align: [
    quality,
    scale,
    knownExtentM,
    knownExtentAxis,
    symmetry,
    cameraUp,
    meshUp,
    initial,
    search,
    workBudget,
    proportions,
    metrics,
    maxObservedPoints,
    surfaceSamples,
    seed,
  ],
  paper: [
    seed,
    { ...maxObservedPoints, summary: "Upper bound on the depth readings used" },
    { ...surfaceSamples, default: 20000, summary: "Number of points sampled on the mesh surface" },
    metrics,
    voxelDivisions,
    fpfhRadiusVoxels,
    { name: "guard", kind: "guard", isNullable: true, default: [0.5, 1.5], summary: "Bounds [λmin, λmax] of the scale relative to the initial scale" },
    { name: "guardMode", kind: "choice", choices: ["reject", "clamp"], isNullable: false, default: "reject", summary: "What RANSAC does with a hypothesis whose scale is outside the guard" },
    ransacIterations,
    ransacConfidence,
    inlierDistanceVoxels,
    edgeSimilarity,
    { name: "hallucinationFilter", kind: "boolean", isNullable: false, default: true, summary: "Whether mesh regions without support by the observation are left out" },
    { name: "supportDistanceVoxels", kind: "number", min: 0.1, max: 50, isNullable: false, default: 3, summary: "Largest distance to an observed point that counts as support, in voxels" },
    { name: "supportAngleDeg", kind: "number", min: 0, max: 180, isNullable: false, default: 60, summary: "Largest angle between the two normals that counts as support, in degrees" },
    icp,
    { name: "lockScale", kind: "boolean", isNullable: false, default: true, summary: "Whether ICP leaves the scale as RANSAC found it (§3.3)" },
    icpIterations,
  ],
  alignScene: [
    quality,
    scale,
    knownExtentM,
    knownExtentAxis,
    symmetry,
    cameraUp,
    meshUp,
    search,
    workBudget,
    proportions,
    metrics,
    maxObservedPoints,
    surfaceSamples,
    seed,
    { name: "snap", kind: "boolean", isNullable: false, default: false, summary: "Whether to move each object that touches something along the normal of the support, so that it touches exactly" },
  ],
  alignViews: [
    quality,
    scale,
    knownExtentM,
    knownExtentAxis,
    symmetry,
    { ...proportions, summary: "Whether to fit the proportions of the mesh to all views together, as in `align`" },
    { ...metrics, summary: "Whether to compute the `metrics` of each view" },
    { ...maxObservedPoints, summary: "Upper bound on the depth readings of each view that are used for metrics" },
    { ...surfaceSamples, summary: "Number of points sampled on the mesh surface for metrics" },
    seed,
  ],
  track: [
    quality,
    scale,
    knownExtentM,
    knownExtentAxis,
    symmetry,
    { ...initial, summary: "The pose in the first frame, camera from mesh, in metres, if it is known" },
    { ...metrics, default: false, summary: "Whether to compute `metrics` of each frame that has a mask, which takes several times as long as tracking" },
    seed,
  ],
  evaluate: [
    { name: "truth", kind: "transform", isNullable: true, default: null, summary: "The known transform, camera from mesh, that `errors` compares with" },
    { ...symmetry, summary: "The object's symmetry: the rotation error is the smallest over it" },
    seed,
    { ...maxObservedPoints, summary: "Upper bound on the depth readings used" },
    { ...surfaceSamples, summary: "Number of points sampled on the mesh surface" },
    { name: "measuredPoints", kind: "integer", min: 32, max: 1000000, isNullable: false, default: 1024, summary: "Number of points, evenly spread over those of each side, from which distances and normals are measured" },
  ],
  register: [
    { ...scale, summary: "The scale in target units per source unit: `\"free\"`, a known number (1 for rigid registration), or bounds `[min, max]`" },
    seed,
    { name: "maxPoints", kind: "integer", min: 32, max: 1000000, isNullable: false, default: 20000, summary: "Upper bound on the points used of each cloud" },
    { name: "voxelSize", kind: "number", above: 0, isNullable: true, default: null, summary: "Voxel size in target units" },
    { ...voxelDivisions, isNullable: true, default: null, summary: "Voxels along the diagonal of the target's bounding box" },
    fpfhRadiusVoxels,
    ransacIterations,
    ransacConfidence,
    inlierDistanceVoxels,
    edgeSimilarity,
    icp,
    icpIterations,
    { ...workBudget, summary: "An upper bound on the work, in units of about a millisecond on a 2020 laptop" },
  ],
  estimateSim3: [
    { ...scale, summary: "The scale in target units per source unit: `\"free\"`, a known number (1 for a rigid transform), or bounds `[min, max]`" },
    seed,
    { name: "inlierDistance", kind: "number", above: 0, isNullable: true, default: null, summary: "Distance below which a correspondence counts as an inlier, in target units" },
    ransacIterations,
    ransacConfidence,
    edgeSimilarity,
    { ...workBudget, summary: "An upper bound on the work, in units of about a millisecond on a 2020 laptop" },
  ],
}))();
