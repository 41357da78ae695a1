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
export { OPTIONS } from "./generated/options.js";
export type {
  Alternative,
  Contact,
  CorrectedFrame,
  DepthCalibration,
  Metrics,
  PoseErrors,
  Preset,
  Quality,
  Stage,
  Uncertainty,
  Warning,
  WarningCode,
} from "./generated/types.js";
export type { Sim3, Sim3Like } from "./input/sim3.js";
export type { WasmModules } from "./modules/modules.js";
export type {
  AlignInput,
  CameraFileInput,
  CameraInput,
  CocoRle,
  DepthCode,
  DepthCoding,
  DepthInput,
  DepthKind,
  DepthView,
  EncodedBytes,
  FrameInput,
  MaskInput,
  MaskJson,
  MeshArrays,
  MeshFile,
  MeshFormat,
  MeshInput,
  PhotoInput,
  PinholeCamera,
  ViewInput,
  ViewsInput,
} from "./types/inputs.js";
export type {
  AlignAllOptions,
  AlignOptions,
  CallOptions,
  EstimateSim3Options,
  EvaluateOptions,
  OptionRow,
  PaperOptions,
  Progress,
  RegisterOptions,
  ScaleOption,
  SymmetryOption,
  TrackOptions,
  ViewsOptions,
} from "./types/options.js";
export type { WasmSource, WorkerLike } from "./types/platform.js";
export type {
  AlignAllResult,
  Alignment,
  AlignResult,
  Evaluation,
  PaperAlignment,
  Registration,
  TrackedFrame,
  ViewAlignment,
  ViewsAlignment,
} from "./types/results.js";
export type {
  Plane,
  SceneAlignment,
  SceneFailure,
  SceneInput,
  SceneObjectInput,
  SceneOptions,
  SceneResult,
  Support,
} from "./types/scene.js";
export { type ErrorCode, Sim3AlignError } from "./values/error.js";
export type { PixelArray } from "./values/pixels.js";
export { PreparedMesh } from "./values/prepared-mesh.js";
