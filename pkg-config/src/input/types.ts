/** What `align` and `evaluate` take. */

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
 * - the bytes of a PNG or of a `.npy` array, known by how they begin;
 * - COCO RLE.
 */
export type MaskInput =
  | Uint8Array
  | Uint8ClampedArray
  | PixelArray<Uint8Array | Uint8ClampedArray>
  | ArrayBuffer
  | Blob
  | CocoRle;

/** Pinhole intrinsics in pixels; pixel centres are at whole numbers: x = (u − cx)·z/fx. */
export interface PinholeCamera {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  /** The image size that the intrinsics belong to; compared with the depth map's. */
  width?: number | undefined;
  height?: number | undefined;
}

/** Intrinsics as a matrix: 9 numbers row by row, or three rows of three. */
export interface MatrixCamera {
  K: ArrayLike<number> | readonly (readonly number[])[];
  width?: number | undefined;
  height?: number | undefined;
}

/** A vertical field of view in degrees, for square pixels and a principal point in the middle of the image. */
export interface FieldOfViewCamera {
  fovYDeg: number;
  width?: number | undefined;
  height?: number | undefined;
}

/**
 * The camera that took the depth map: intrinsics, or a camera file, as bytes, text or parsed JSON: our own
 * `camera.json`, BOP's `scene_camera.json` (choose with `imageId`), ROS CameraInfo, Open3D's intrinsics.
 */
export type CameraInput =
  | PinholeCamera
  | MatrixCamera
  | FieldOfViewCamera
  | Readonly<Record<string, unknown>>
  | EncodedBytes
  | string;

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
  /** Told from the content by default. */
  format?: MeshFormat | undefined;
  /** The buffers of a `.gltf`, by the URIs that it names them with. */
  resources?: Readonly<Record<string, Uint8Array | ArrayBuffer>> | undefined;
}

/** The object's mesh, in its own frame: arrays, or a GLB, glTF, OBJ, PLY or STL file (node transforms are applied). */
export type MeshInput = MeshArrays | MeshFile | EncodedBytes;

interface CommonInput {
  /** Which pixels show the object. */
  mask: MaskInput;
  /** The mesh to be aligned. */
  mesh: MeshInput;
  /** Pixels in a row. Needed with a bare typed array, else taken from the depth or the point map. */
  width?: number | undefined;
  /** Rows. Needed with a bare typed array, else taken from the depth or the point map. */
  height?: number | undefined;
  /** How a mask of another size than the depth map's is brought to it. By default that is an error. */
  resizeMask?: "nearest" | undefined;
}

/** An object seen in a depth map. */
export interface DepthAlignInput extends CommonInput {
  /** The depth map. */
  depth: DepthInput;
  /**
   * Metres per unit of depth, above 0: 0.001 for millimetres. By default whole numbers take it from the camera file, or
   * else are millimetres, and floats are metres.
   */
  depthScale?: number | undefined;
  /** The camera that took the depth map. */
  camera: CameraInput;
  /** Which entry of a BOP `scene_camera.json`. */
  imageId?: string | number | undefined;
  pointMap?: undefined;
}

/** An object seen in a point map. */
export interface PointMapAlignInput extends CommonInput {
  /**
   * x, y, z per pixel (height × width × 3), metres, in the OpenCV camera frame: x right, y down, z forward.
   */
  pointMap: Float32Array | PixelArray<Float32Array>;
  /** The camera. By default it follows from the point map. */
  camera?: CameraInput | undefined;
  /** Which entry of a BOP `scene_camera.json`. */
  imageId?: string | number | undefined;
  depth?: undefined;
  depthScale?: undefined;
}

/** What `align` and `evaluate` look at: depth with camera, or a point map; the mask; the mesh. */
export type AlignInput = DepthAlignInput | PointMapAlignInput;
