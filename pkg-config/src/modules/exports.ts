/** The exports of the WebAssembly modules. Their functions validate their arguments and throw errors with codes. */
import type { Pinhole } from "../camera/pinhole.js";
import type {
  Alignment,
  Contact,
  CorrectedFrame,
  DepthCalibration,
  Evaluation,
  PaperAlignment,
  Registration,
  Sim3,
  Stage,
  TrackedFrame,
  ViewsAlignment,
} from "../generated/types.js";
import type { DecodeImage } from "../input/webp.js";
import type { Exif, ExternalResources, MaskFromFile, MeshFromFile } from "../types/files.js";
import type { DepthImage, MeshFile, ReadDepthOptions } from "../types/inputs.js";
import type { Support } from "../types/scene.js";
import type { PixelArray } from "../values/pixels.js";
import type { CoreMesh } from "../values/prepared-mesh.js";
import type { CoreFrame, CoreInput, CoreView, CoreViews } from "./core-input.js";

/** The modules of the aligner, by their names among the options. */
export interface Exports {
  core: Core;
  formats: Formats;
  depthFiles: DepthFiles;
  splats: Splats;
  webp: Webp;
  joint: Joint;
  registration: Registrar;
}

/** The name of a module among the options. */
export type ModuleName = keyof Exports;

/**
 * Called when a stage begins and after each round of a search, with the best pose (16 numbers) and its score, if any.
 * Must not throw.
 */
export type CoreListener = (stage: Stage, fraction: number, best?: Float64Array) => void;

/** A task of a module that runs in slices, so that the thread can do other work between them. */
export interface Task<T> {
  /** Runs for about this long; returns the result when finished. */
  step(sliceMs: number): T | undefined;
  free(): void;
}

/** The helpers of a task, other threads, as a module calls them. */
export interface CoreHelpers {
  /** Asks for helpers. */
  ask(): void;
  send(helper: number, message: Float64Array): void;
  /** The next message that has arrived. Its first number is the helper; a message of that number alone means that it has left. */
  receive(): Float64Array | undefined;
  /** Lets the next turn last until a message arrives. */
  wait(): void;
}

/** Runs tasks of a search in another thread. */
export interface Helper {
  /** Reads a message of the search. */
  receive(message: Float64Array): void;
  /**
   * Runs tasks for about this long; returns the message about them, whose first number is for the helper, or `undefined` if
   * there is nothing to do.
   */
  step(sliceMs: number): Float64Array<ArrayBuffer> | undefined;
  free(): void;
}

/** Begins a search, with which other threads may help. */
type BeginSearch<I, T> = (
  input: I,
  options: object,
  onProgress: CoreListener | undefined,
  helpers: CoreHelpers | undefined,
) => Task<T>;

/** Prepares help with a search that has begun with the same arguments. */
type BeginHelp<I> = (input: I, options: object) => Helper;

/** A module that caches prepared meshes, by their ids. */
interface MeshCache {
  dropMesh(id: number): void;
}

/** The core module. */
export interface Core extends MeshCache {
  beginAlign: BeginSearch<CoreInput, Alignment>;
  beginHelp: BeginHelp<CoreInput>;
  evaluate(input: CoreInput, transform: unknown, options: object): Evaluation;
  /** The depth of a mesh at a pose, metres; 0 where no mesh is. */
  renderDepth(
    view: { mesh: CoreMesh; width: number; height: number; camera: Pinhole },
    transform: unknown,
  ): Float32Array;
  prepareMesh(mesh: CoreMesh): void;
  version(): string;
}

/** Readers of mesh files, images and NPY. */
export interface Formats {
  readMesh(bytes: Uint8Array, options: ReadMeshOptions): MeshFromFile;
  externalResources(bytes: Uint8Array): ExternalResources;
  readImage(bytes: Uint8Array, asStored: boolean): PixelArray<Uint8Array>;
  readExif(bytes: Uint8Array): Exif;
  readDepth(bytes: Uint8Array, options: ReadDepthOptions): DepthImage;
  readMask(bytes: Uint8Array): MaskFromFile;
}

/** The options of the reader of mesh files. */
export interface ReadMeshOptions extends Omit<MeshFile, "bytes"> {
  colors?: boolean | undefined;
  decodeImage?: DecodeImage | undefined;
}

/** The reader of depth maps as depth models write them (NPZ, EXR, TIFF, PFM). */
export interface DepthFiles {
  readDepthFile(bytes: Uint8Array, options: object): DepthImage;
}

/** The maker of meshes of 3D Gaussians. */
export interface Splats {
  readSplats(bytes: Uint8Array, withColors: boolean): MeshFromFile;
}

/** The decoder of WebP. */
export interface Webp {
  decodeWebp(bytes: Uint8Array, asStored: boolean): PixelArray<Uint8Array> & { exif?: Uint8Array };
}

/** The module with `register`, `estimateSim3` and the preset `paper`. */
export interface Registrar {
  alignPaper(input: CoreInput, options: object, onProgress: CoreListener | undefined): PaperAlignment;
  beginRegister(source: Cloud, target: Cloud, options: object): Task<Registration>;
  beginEstimateSim3(source: Cloud, target: Cloud, correspondences: Uint32Array, options: object): Task<Registration>;
}

/** Points as interleaved x, y, z. */
type Cloud = Float32Array | Float64Array;

/** The module with `alignScene`, `alignViews` and `track`. */
export interface Joint extends MeshCache {
  beginPlace: BeginSearch<PlacedInput, Placed>;
  beginHelpPlace: BeginHelp<PlacedInput>;
  planScene(
    scene: object,
    plan: Uint8Array | undefined,
    placements: (Uint8Array | null)[],
  ): { plan: Uint8Array } | Arrangement;
  beginCalibrate(
    input: CoreView & { objects: CalibrationObject[] },
    onProgress: CoreListener | undefined,
  ): Task<Calibrated>;
  beginCalibrateViews(input: CoreViews & { options: object }, onProgress: CoreListener | undefined): Task<Calibrated[]>;
  beginAlignViews: BeginSearch<CoreViews, ViewsAlignment>;
  beginHelpViews: BeginHelp<CoreViews>;
  openTracker(id: number, input: { mesh: CoreMesh }, options: object): void;
  beginTrackFrame(
    id: number,
    frame: CoreFrame,
    onProgress: CoreListener | undefined,
  ): Task<TrackedFrame & { depthCalibration?: DepthCalibration }>;
  correctTrack(id: number, pose: unknown, frame: unknown): CorrectedFrame[];
  closeTracker(id: number): void;
}

/** An object by which a view is calibrated. */
export interface CalibrationObject extends Pick<CoreFrame, "mask" | "maskWidth" | "maskHeight" | "resizeMask"> {
  /** The pixels of other objects. */
  others?: Uint8Array | undefined;
  mesh: CoreMesh;
  /** Options of `align`, in the form of the core. */
  options: object;
}

/** The depth map of a calibrated view, and its calibration. */
export interface Calibrated {
  /** In metres if the calibration is metric. */
  depth: Float32Array;
  calibration: DepthCalibration;
}

/** An object of a scene. */
export interface PlacedInput extends CoreInput {
  /** The pixels of the other objects. */
  others?: Uint8Array | undefined;
  /** The plan of the scene, which only the module reads; none in the first round. */
  plan?: Uint8Array | undefined;
  /** The number of the object. */
  index: number;
  /** The uncertainty of the calibration of the scene. */
  uncertainty?: object | undefined;
}

/** An object of a scene, aligned in one of its rounds. */
export interface Placed {
  /** Its message to the next round; only the module reads it. */
  placement: Uint8Array;
  /** The result, in the last round. */
  alignment?: Alignment;
  /** The origin of its mesh, which its placement is relative to. */
  origin?: readonly number[];
}

/** The poses of the objects of a scene, `null` for one that could not be aligned, and what they stand on. */
export interface Arrangement {
  plan?: undefined;
  objects: ((Pick<Sim3, "translation" | "matrix"> & { contact: Contact }) | null)[];
  support: Support | null;
}
