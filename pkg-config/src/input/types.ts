/** The input of `align` and `evaluate`. */
import type { PreparedMesh } from "../prepared-mesh.js";

/** An encoded file as it was read or fetched. */
export type EncodedBytes = Uint8Array | ArrayBuffer | Blob;

/** Pixels with their size: `data` has width × height values, row by row from the top left. */
export interface PixelArray<T> {
  data: T;
  /** Pixels in a row. */
  width: number;
  /** Rows. */
  height: number;
}

/**
 * A depth map: z-depth (along the optical axis, not along the ray), row by row. 0, negative, NaN and infinite values
 * are "no reading".
 *
 * - `Float32Array`: metres (times `depthScale`, where that is given); with `width` and `height` in the input;
 * - `Uint16Array`: multiplied by `depthScale`; with `width` and `height` in the input;
 * - either of these as `{ data, width, height }`;
 * - the bytes of a 16-bit grey PNG (multiplied by `depthScale`) or of a `.npy` array.
 */
export type DepthInput = Float32Array | Uint16Array | PixelArray<Float32Array | Uint16Array> | EncodedBytes;

/** COCO's run-length encoding, compressed (`counts` is a string) or not; `size` is [height, width]. */
export interface CocoRle {
  size: readonly [height: number, width: number];
  counts: string | readonly number[];
}

/**
 * Which pixels show the object, row by row; non-zero is the object.
 *
 * - `Uint8Array` of the depth map's size, one byte per pixel;
 * - `{ data, width, height }`, for one of another size (see `resizeMask`);
 * - the bytes of a PNG or of a `.npy` array, recognised by their first bytes;
 * - COCO RLE, as an object or as the bytes of a JSON file.
 */
export type MaskInput =
  | Uint8Array
  | Uint8ClampedArray
  | PixelArray<Uint8Array | Uint8ClampedArray>
  | ArrayBuffer
  | Blob
  | CocoRle;

/** The image size that intrinsics belong to; compared with the depth map's. */
interface CameraSize {
  /** Pixels in a row. */
  width?: number | undefined;
  /** Rows. */
  height?: number | undefined;
}

/** Pinhole intrinsics in pixels; pixel centres are at whole numbers: x = (u − cx)·z/fx. */
export interface PinholeCamera extends CameraSize {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  K?: undefined;
  fovYDeg?: undefined;
}

/** No other form of intrinsics beside a matrix or a field of view. */
interface NoPinhole {
  fx?: undefined;
  fy?: undefined;
  cx?: undefined;
  cy?: undefined;
}

/** Intrinsics as a matrix: 9 numbers row by row, or three rows of three. */
export interface MatrixCamera extends CameraSize, NoPinhole {
  K: ArrayLike<number> | readonly (readonly number[])[];
  fovYDeg?: undefined;
}

/** A vertical field of view in degrees, for square pixels and a principal point in the middle of the image. */
export interface FieldOfViewCamera extends CameraSize, NoPinhole {
  fovYDeg: number;
  K?: undefined;
}

/** The intrinsics of the camera that took the depth map. */
export type CameraInput = PinholeCamera | MatrixCamera | FieldOfViewCamera;

/**
 * A camera file: its bytes, its text, or its parsed JSON. Known are our own `camera.json`, BOP's `scene_camera.json`
 * (choose the entry with `imageId`), ROS CameraInfo, and the intrinsics of Open3D and RealSense.
 */
export type CameraFileInput = EncodedBytes | string | Readonly<Record<string, unknown>>;

/** The mesh formats that are read. */
export type MeshFormat = "glb" | "gltf" | "obj" | "ply" | "stl";

/** A mesh as arrays. */
export interface MeshArrays {
  /** x, y, z per vertex, in any unit. */
  positions: Float32Array;
  /** Three vertex indices per triangle; without them every three vertices are a triangle. */
  indices?: Uint32Array | Uint16Array | null | undefined;
}

/** A mesh file. */
export interface MeshFile {
  bytes: EncodedBytes;
  /** By default it is recognised by the content. */
  format?: MeshFormat | undefined;
  /** The buffers of a `.gltf`, by the URIs in it. */
  resources?: Readonly<Record<string, Uint8Array | ArrayBuffer>> | undefined;
}

/** The object's mesh, in its own frame: arrays, a GLB, glTF, OBJ, PLY or STL file (node transforms are applied), or a prepared mesh. */
export type MeshInput = MeshArrays | MeshFile | EncodedBytes | PreparedMesh;

/** The mask and the mesh of an input. */
export interface ObjectInput {
  /** Which pixels show the object. */
  mask: MaskInput;
  /** The mesh to be aligned. */
  mesh: MeshInput;
  /** How to bring a mask of another size to the depth map's. By default that is an error. */
  resizeMask?: "nearest" | undefined;
}

/** Intrinsics, stated. */
export interface StatedCameraInput {
  /** The intrinsics of the camera that took the depth map. */
  camera: CameraInput;
  cameraFile?: undefined;
  imageId?: undefined;
}

/** Intrinsics from a file. */
export interface CameraFromFileInput {
  camera?: undefined;
  /** A camera file. Whole-number depth takes its scale from it, unless `depthScale` is given. */
  cameraFile: CameraFileInput;
  /** Which entry of a BOP `scene_camera.json`. */
  imageId?: string | number | undefined;
}

/** No camera: intrinsics follow from the point map. */
export interface NoCameraInput {
  camera?: undefined;
  cameraFile?: undefined;
  imageId?: undefined;
}

/** A depth map that may be a bare array, whose size the input states. */
export interface SizedDepthInput {
  /** The depth map. */
  depth: DepthInput;
  /** Pixels in a row. */
  width: number;
  /** Rows. */
  height: number;
}

/** A depth map that brings its size along. */
export interface OwnSizeDepthInput {
  /** The depth map. */
  depth: Exclude<DepthInput, Float32Array | Uint16Array>;
  /** Pixels in a row; compared with the depth map's. */
  width?: number | undefined;
  /** Rows; compared with the depth map's. */
  height?: number | undefined;
}

/** A point map that may be a bare array, whose size the input states. */
export interface SizedPointMapInput {
  /** x, y, z per pixel (height × width × 3), metres, in the OpenCV camera frame: x right, y down, z forward. */
  pointMap: Float32Array | PixelArray<Float32Array>;
  /** Pixels in a row. */
  width: number;
  /** Rows. */
  height: number;
}

/** A point map that brings its size along. */
export interface OwnSizePointMapInput {
  /** x, y, z per pixel (height × width × 3), metres, in the OpenCV camera frame: x right, y down, z forward. */
  pointMap: PixelArray<Float32Array>;
  /** Pixels in a row; compared with the point map's. */
  width?: number | undefined;
  /** Rows; compared with the point map's. */
  height?: number | undefined;
}

/** An object seen in a depth map. */
export type DepthAlignInput = ObjectInput &
  (SizedDepthInput | OwnSizeDepthInput) &
  (StatedCameraInput | CameraFromFileInput) & {
    /**
     * Metres per unit of depth, above 0: 0.001 for millimetres. By default floats are metres, and whole numbers take
     * the scale from the camera file, or else are millimetres.
     */
    depthScale?: number | undefined;
    pointMap?: undefined;
  };

/** An object seen in a point map. Without a camera, the intrinsics follow from the point map. */
export type PointMapAlignInput = ObjectInput &
  (SizedPointMapInput | OwnSizePointMapInput) &
  (StatedCameraInput | CameraFromFileInput | NoCameraInput) & {
    depth?: undefined;
    depthScale?: undefined;
  };

/** The input of `align` and `evaluate`: depth with a camera, or a point map; the mask; the mesh. */
export type AlignInput = DepthAlignInput | PointMapAlignInput;
