/**
 * Types of parts of arguments and results, for the reference only: a property of what is exported leads to each of them, such
 * as `Alignment["diagnostics"]["counts"]`.
 * @packageDocumentation
 */
export type { BopPose, BopSymmetries } from "./conventions/bop.js";
export type { Cuboid, CuboidOptions, MeshAxis } from "./conventions/cuboid.js";
export type { CvatCuboid } from "./conventions/cvat-cuboid.js";
export type { CvatMaskElement } from "./conventions/cvat-rle.js";
export type { DepthCorrection } from "./conventions/depth.js";
export type { CameraFrame } from "./conventions/frames.js";
export type { GeneratorFrame } from "./conventions/generators.js";
export type { GlbOptions } from "./conventions/glb.js";
export type { MogeOutput } from "./conventions/moge.js";
export type { OrientedBoundingBox } from "./conventions/oriented-bounding-box.js";
export type { ImagesAndCamera, PixelBox } from "./conventions/resize.js";
export type { Nested, Sam3dLayout, Sam3dVertices } from "./conventions/sam3d.js";
export type { SceneCamera } from "./conventions/scene-frame.js";
export type { SceneGlbObject, SceneGlbOptions, TimedPose } from "./conventions/scene-glb.js";
export type { StretchLike } from "./conventions/stretch.js";
export type { MaskChoice, TensorLike } from "./conventions/tensor.js";
export type { Upright, UprightOptions } from "./conventions/upright.js";
export type {
  CalibrationUncertainty,
  CameraPose,
  ColorReport,
  ColorVerdict,
  Counts,
  Diagnostics,
  Effort,
  EvaluationDiagnostics,
  ExtentAxis,
  FoundSymmetry,
  GuardMode,
  Icp,
  PaperDiagnostics,
  PreciseDiagnostics,
  Proportions,
  RegistrationDiagnostics,
  ScoreTerms,
  SearchCounts,
  SearchScope,
  Stretch,
  Timings,
  TrackState,
  ViewRole,
  ViewsDiagnostics,
  WorldFrame,
  WorldUncertainty,
} from "./generated/types.js";
export type { ThreeMesh } from "./three/mesh-input.js";
export type { Range } from "./three/types.js";
export type { Direction, SymmetryAxis } from "./types/argument-types.js";
export type { ColorSamples } from "./types/files.js";
export type { DepthNumbers, FieldOfViewCamera, MatrixCamera, UnknownCamera } from "./types/inputs.js";
export type { OptionsOf } from "./types/options.js";
export type { BlobLike, NodeWorkerLike, SignalLike, UrlLike, WebWorkerLike, WorkerEvent } from "./types/platform.js";
export type { LabelMap, SceneMetrics } from "./types/scene.js";
export type { ErrorParts } from "./values/error.js";
export type { DepthPixels, ImageSize, MaskPixels } from "./values/pixels.js";
export type { Quaternion, Vector3 } from "./values/validation.js";
