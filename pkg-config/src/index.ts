/**
 * Puts a generated 3D mesh where it really is, at its real size, from one masked depth map.
 *
 * Camera frame: OpenCV (x right, y down, z forward), metres. Transforms: x_cam = s·R·p_mesh + t; matrices are
 * column-major, quaternions x, y, z, w.
 * @packageDocumentation
 */
export { Aligner, type AlignerOptions, createAligner } from "./aligner.js";
export { type ErrorCode, type ErrorParts, Sim3AlignError } from "./error.js";
export type {
  Counts,
  ExtentAxis,
  GuardMode,
  Icp,
  Metrics,
  PoseErrors,
  Preset,
  Quality,
  ScoreTerms,
  SearchScope,
  Stage,
  Uncertainty,
} from "./generated/types.js";
export type {
  AlignInput,
  CameraFileInput,
  CameraInput,
  CocoRle,
  DepthAlignInput,
  DepthInput,
  EncodedBytes,
  FieldOfViewCamera,
  MaskInput,
  MatrixCamera,
  MeshArrays,
  MeshFile,
  MeshFormat,
  MeshInput,
  PinholeCamera,
  PixelArray,
  PointMapAlignInput,
} from "./input/types.js";
export type {
  AlignAllOptions,
  AlignOptions,
  BestSoFar,
  CallOptions,
  Defaults,
  Direction,
  EstimateOptions,
  EvaluateOptions,
  Progress,
  RegisterOptions,
  ScaleBounds,
  ScaleOption,
  SymmetryAxis,
  SymmetryOption,
} from "./options.js";
export type { CreateWorker, WasmSource, WorkerLike } from "./platform.js";
export type {
  AlignAllResult,
  Alignment,
  Alternative,
  Clouds,
  Evaluation,
  Registration,
  Warning,
  WarningCode,
} from "./results.js";
export type { Sim3, Sim3Like } from "./sim3.js";
