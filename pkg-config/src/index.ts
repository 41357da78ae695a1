/**
 * Aligns generated 3D meshes with a masked depth map, in pose and metric scale.
 *
 * Camera frame: OpenCV (x right, y down, z forward), metres. Transforms: x_cam = s·R·p_mesh + t; matrices are
 * column-major, quaternions x, y, z, w.
 * @packageDocumentation
 */
export { Aligner, createAligner } from "./aligner/aligner.js";
export type { AlignerOptions } from "./aligner/aligner-options.js";
export { Tracker } from "./aligner/tracker.js";
export {
  ALIGN_DEFAULTS,
  ESTIMATE_SIM3_DEFAULTS,
  EVALUATE_DEFAULTS,
  OPTIONS,
  PAPER_DEFAULTS,
  REGISTER_DEFAULTS,
  TRACK_DEFAULTS,
  VIEWS_DEFAULTS,
} from "./generated/options.js";
export type {
  Alternative,
  CalibrationUncertainty,
  CameraPose,
  ColorReport,
  ColorVerdict,
  Contact,
  CorrectedFrame,
  Counts,
  DepthCalibration,
  Diagnostics,
  Effort,
  EvaluationDiagnostics,
  ExtentAxis,
  GuardMode,
  Icp,
  LayoutErrors,
  Metrics,
  PaperDiagnostics,
  PoseErrors,
  PreciseDiagnostics,
  Preset,
  Proportions,
  Quality,
  RegistrationDiagnostics,
  ScoreTerms,
  SearchCounts,
  SearchScope,
  Stage,
  Stretch,
  Timings,
  TrackState,
  Uncertainty,
  ViewRole,
  ViewsDiagnostics,
  Warning,
  WarningCode,
  WorldFrame,
  WorldUncertainty,
} from "./generated/types.js";
export type { Sim3, Sim3Like } from "./input/sim3.js";
export type { WasmModules } from "./modules/modules.js";
export type {
  AlignInput,
  CameraFileInput,
  CameraInput,
  CocoRle,
  DepthInput,
  DepthKind,
  DepthView,
  EncodedBytes,
  FieldOfViewCamera,
  FrameInput,
  MaskInput,
  MatrixCamera,
  MeshArrays,
  MeshFile,
  MeshFormat,
  MeshInput,
  PhotoInput,
  PinholeCamera,
  UnknownCamera,
  ViewInput,
  ViewsInput,
} from "./types/inputs.js";
export type {
  AlignAllOptions,
  AlignOptions,
  CallOptions,
  Direction,
  EstimateSim3Options,
  EvaluateOptions,
  OptionRow,
  OptionsOf,
  PaperOptions,
  Progress,
  RegisterOptions,
  ScaleOption,
  SymmetryAxis,
  SymmetryOption,
  TrackOptions,
  ViewsOptions,
} from "./types/options.js";
export type { BlobLike, SignalLike, UrlLike, WasmSource, WorkerLike } from "./types/platform.js";
export type {
  AlignAllResult,
  Alignment,
  AlignResult,
  Evaluation,
  InputInfo,
  PaperAlignment,
  Registration,
  TrackedFrame,
  ViewAlignment,
  ViewsAlignment,
} from "./types/results.js";
export type {
  LabelMap,
  Plane,
  SceneAlignment,
  SceneFailure,
  SceneInput,
  SceneMetrics,
  SceneObjectInput,
  SceneOptions,
  SceneResult,
  Support,
} from "./types/scene.js";
export { type ErrorCode, type ErrorParts, Sim3AlignError } from "./values/error.js";
export type { PixelArray } from "./values/pixels.js";
export { PreparedMesh } from "./values/prepared-mesh.js";
export type { ColorSamples } from "./wasm/formats.js";
