/** What a host sees of `<sim3-align>`. The types of inputs and metrics are those of the package `sim3align`. */
import type {
  CameraInput,
  DepthCalibration,
  DepthKind,
  EncodedBytes,
  MeshArrays,
  Metrics,
  PixelArray,
  Preset,
  Quality,
  Sim3,
  Sim3Like,
} from "sim3align";

/** An object of a given scene. */
export interface GivenObject {
  /** “Object 1” and so on by default. */
  name?: string | undefined;
  /** One byte per pixel of the depth map, not 0 is the object; or an encoded PNG or NPY file. */
  mask: Uint8Array | Uint8ClampedArray | PixelArray<Uint8Array> | EncodedBytes;
  /** Arrays, or an encoded GLB, PLY, STL or OBJ file. */
  mesh: MeshArrays | EncodedBytes;
}

/** A scene in memory. */
export interface GivenScene {
  name?: string | undefined;
  /**
   * z-depth: metres, or 16-bit integers times `depthScale`, with `width` and `height`; or an encoded PNG, NPY, NPZ, EXR,
   * TIFF or PFM file.
   */
  depth: Float32Array | Uint16Array | EncodedBytes;
  width?: number | undefined;
  height?: number | undefined;
  /** Metres per unit of depth. By default, integers are millimetres, and floats metres. */
  depthScale?: number | undefined;
  /** What the values of the depth map are; `"metric"` by default. Others are calibrated by the objects. */
  depthKind?: DepthKind | undefined;
  /** By default, that in the depth file or in the EXIF data of the photo; or estimated together with the poses. */
  camera?: CameraInput | undefined;
  /** The photo of the depth map's view: an image file or pixels (red, green, blue, alpha). */
  image?: Blob | ImageData | undefined;
  objects: readonly GivenObject[];
}

/** What the property `scene` accepts. */
export type GivenInput = GivenScene | Blob | readonly File[] | string;

/** The result of an object. */
export interface ObjectResult {
  name: string;
  /** OpenCV camera from mesh, in metres if `isMetric`; null before the first alignment. */
  pose: Sim3 | null;
  source: "start" | "aligned" | "alternative" | "refined" | "hand" | "tracked";
  /** Sides of the smallest box around the object, named after the nearest axes x, y and z of the mesh; null without a pose. */
  sizeM: number[] | null;
  /** Whether lengths are metres. Otherwise, the unit of all lengths is unknown, but the same for all objects. */
  isMetric: boolean;
  /** Of an aligned pose only. */
  confidence: number | null;
  isAccepted: boolean;
  metrics: Metrics | null;
}

/** Options of the alignments. */
export interface ElementOptions {
  preset: Preset;
  quality: Quality;
  /** Bounds of the scale, metres per mesh unit; null is none. */
  scaleMin: number | null;
  scaleMax: number | null;
  /** The mesh axis that points up, for a level camera and an object that stands upright. */
  up: "unknown" | "y" | "z";
  symmetry: "auto" | "none";
  seed: number;
}

/** Hand work and results, without the files of the scene. Plain data, to be kept and set again. */
export interface ElementSession {
  version: 1;
  options: ElementOptions;
  objects: { name: string; state: object }[];
  /** What depth and focal length were taken to be, if they were not known; the poses are in this depth. */
  calibration?: DepthCalibration | null | undefined;
}

/** The details of the events. */
export interface ElementEvents {
  /** A scene is shown. */
  ready: { name: string; objects: string[] };
  /** 0 to 1, while objects are being aligned. */
  progress: { fraction: number };
  /** An alignment or a refinement has ended. */
  align: { objects: ObjectResult[] };
  /** A pose has changed: by an alignment, by hand (with every step of a drag), or by an alternative. */
  posechange: { name: string; pose: Sim3; source: string };
  /** A person has accepted a pose, or a change has made it open again. */
  accept: ObjectResult;
  /** A scene could not be read, or an object could not be aligned. */
  error: { message: string; name: string | null; code: string | null };
}

/** The events by name, as `HTMLElementEventMap` has those of all elements. */
export type Sim3AlignEventMap = Omit<HTMLElementEventMap, keyof ElementEvents> & {
  [K in keyof ElementEvents]: CustomEvent<ElementEvents[K]>;
};

/** A scene with its objects, to be aligned and corrected. */
export declare class Sim3AlignElement extends HTMLElement {
  /** The scene. Setting it shows it and, unless a pose or session is given with it, aligns it. */
  get scene(): GivenInput | null;
  set scene(given: GivenInput | null);
  /** The pose of the selected object: OpenCV camera from mesh, metres; null before the first alignment. */
  get pose(): Sim3 | null;
  set pose(pose: Sim3Like | null);
  /** The name of the selected object. */
  get selected(): string | null;
  set selected(name: string | null);
  /** The options of the alignments. Those that are not set keep their values. */
  get options(): ElementOptions;
  set options(options: Partial<ElementOptions>);
  /** Whether the scene is read-only. */
  readonly: boolean;
  /** The results of all objects. */
  get results(): ObjectResult[];
  /** Poses, decisions and options as plain data, to be kept and set again with the same scene. */
  get session(): ElementSession;
  set session(session: ElementSession | null);
  /** Aligns all objects that are not locked. Resolves to the results; failures are in the events `error`. */
  align(): Promise<ObjectResult[]>;
  /** Refines the pose of the selected object. */
  refine(): Promise<ObjectResult[]>;

  addEventListener<K extends keyof Sim3AlignEventMap>(
    type: K,
    listener: (this: Sim3AlignElement, event: Sim3AlignEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  removeEventListener<K extends keyof Sim3AlignEventMap>(
    type: K,
    listener: (this: Sim3AlignElement, event: Sim3AlignEventMap[K]) => unknown,
    options?: boolean | EventListenerOptions,
  ): void;
}

/** What JSX of React 19 sets on the element, besides the attributes of every element. */
export type Sim3AlignProps = {
  scene?: GivenInput | null | undefined;
  pose?: Sim3Like | null | undefined;
  selected?: string | null | undefined;
  options?: Partial<ElementOptions> | undefined;
  readonly?: boolean | undefined;
  session?: ElementSession | null | undefined;
  src?: string | undefined;
  manual?: boolean | undefined;
  theme?: "light" | "dark" | undefined;
} & { [K in keyof ElementEvents as `on${K}`]?: ((event: Sim3AlignEventMap[K]) => void) | undefined };

declare global {
  interface HTMLElementTagNameMap {
    "sim3-align": Sim3AlignElement;
  }
}
