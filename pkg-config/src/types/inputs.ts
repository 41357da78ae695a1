/** The inputs of the calls, and what depth files hold. */

import type { PixelArray } from "../values/pixels.js";
import type { PreparedMesh } from "../values/prepared-mesh.js";
import type { Sim3Like } from "./argument-types.js";
import type { ColorSamples } from "./files.js";
import type { BlobLike } from "./platform.js";

/**
 * What the values of a depth map are:
 *
 * - `"metric"`: distances along the optical axis in a known unit;
 * - `"ray-distance"`: distances from the camera's centre, along the ray of each pixel, in a known unit;
 * - `"scale-invariant"`: distances along the optical axis times an unknown factor;
 * - `"affine-invariant"`: distances along the optical axis times an unknown factor, plus an unknown shift;
 * - `"affine-invariant-disparity"`: inverse distances times an unknown factor, plus an unknown shift; near is large.
 */
export type DepthKind =
  | "metric"
  | "ray-distance"
  | "scale-invariant"
  | "affine-invariant"
  | "affine-invariant-disparity";

/**
 * A code in which a program stores depth: numbers that are no multiples of a length. The guide on frames has their formulas.
 *
 * - `"sun-rgbd"`: bits of millimetres, rotated by three;
 * - `"lerobot"`, `"behavior"`: 12 and 14 bits, logarithmic;
 * - `"half-float"`: bits of 16-bit floats, of CO3D;
 * - `"rlbench"`, `"carla"`: 24 bits in red, green and blue; `"rgba-float"`: 32-bit floats in four channels, of TartanAir;
 * - `"z-buffer"`: of OpenGL, MuJoCo and PyBullet.
 */
export type DepthCode =
  | "sun-rgbd"
  | "lerobot"
  | "behavior"
  | "half-float"
  | "rlbench"
  | "carla"
  | "rgba-float"
  | "z-buffer";

/** The code of a depth map, and its range. */
export interface DepthCoding {
  /** The code of the values; by default, they are lengths. Lengths of a code are multiplied by `depthScale`. */
  depthCode?: DepthCode | undefined;
  /** The distance in metres of the near plane, or of the lowest code: of `"rlbench"` and `"z-buffer"`; others have a default. */
  depthNear?: number | undefined;
  /** The same of the far plane, or of the highest code. */
  depthFar?: number | undefined;
}

/** The content of an encoded file, as read or fetched. */
export type EncodedBytes = Uint8Array | ArrayBuffer | BlobLike;

/** The numbers of a depth map. */
export type DepthNumbers = Float32Array | Float64Array | Uint16Array;

/**
 * A depth map: z-depth (along the optical axis, not along the ray), row-major. 0, negative, NaN and infinite values are
 * "no reading".
 *
 * - `Float32Array` or `Float64Array`: metres (times `depthScale`, if given); with `width` and `height` in the input;
 * - `Uint16Array`: multiplied by `depthScale`; with `width` and `height` in the input;
 * - either of these as `{ data, width, height }`;
 * - the bytes of a depth file (NPY, 16-bit PNG, NPZ, EXR, TIFF or PFM); integers are multiplied by `depthScale`. A file of
 *   points (H × W × 3, or 3 × H × W) is read as their depth, with the camera that fits them.
 */
export type DepthInput = DepthNumbers | PixelArray<DepthNumbers> | EncodedBytes;

/** COCO's run-length encoding, compressed (`counts` is a string) or not; `size` is [height, width]. */
export interface CocoRle {
  size: readonly [height: number, width: number];
  counts: string | readonly number[];
}

/**
 * The mask of the object, row-major; non-zero is the object.
 *
 * - `Uint8Array` of the depth map's size, one byte per pixel;
 * - `{ data, width, height }`, for a mask of another size (see the property `resizeMask`);
 * - the bytes of a mask file (PNG, NPY, JSON or JPEG), detected by their signature;
 * - COCO RLE, as an object; or what the JSON of COCO, SAM, LabelMe, VGG Image Annotator, Supervisely, ISAT or Datumaro holds.
 */
export type MaskInput =
  | Uint8Array
  | Uint8ClampedArray
  | PixelArray<Uint8Array | Uint8ClampedArray>
  | ArrayBuffer
  | BlobLike
  | CocoRle
  | MaskJson;

/** The content of a JSON file with masks: see {@link MaskInput}. */
export type MaskJson = Readonly<Record<string, unknown>> | readonly object[];

/** The size of the image that the intrinsics belong to, by default that of the depth map. Others are scaled to it. */
interface CameraSize {
  /** Width in pixels. */
  width?: number | undefined;
  /** Height in pixels. */
  height?: number | undefined;
  /**
   * Relative standard deviation of the focal length, 0 to 1, where it is a guess: 0.1 for 10 %. It is then estimated
   * together with the pose. By default, intrinsics that are given are known.
   */
  focalUncertainty?: number | undefined;
}

/** Pinhole intrinsics in pixels; pixel centres have integer coordinates: x = (u − cx)·z/fx. */
export interface PinholeCamera extends CameraSize {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  K?: undefined;
  fovYDeg?: undefined;
}

/** Excludes fx, fy, cx and cy next to a matrix or a field of view. */
interface NoPinhole {
  fx?: undefined;
  fy?: undefined;
  cx?: undefined;
  cy?: undefined;
}

/** Intrinsics as a matrix: 9 numbers, row-major, or three rows of three. */
export interface MatrixCamera extends CameraSize, NoPinhole {
  K: ArrayLike<number> | readonly (readonly number[])[];
  fovYDeg?: undefined;
}

/** A vertical field of view in degrees, for square pixels and a centred principal point. */
export interface FieldOfViewCamera extends CameraSize, NoPinhole {
  fovYDeg: number;
  K?: undefined;
}

/** The intrinsics of the camera that took the depth map. */
export type CameraInput = PinholeCamera | MatrixCamera | FieldOfViewCamera;

/** A camera of which at most the image size is known. */
export interface UnknownCamera extends CameraSize, NoPinhole {
  K?: undefined;
  fovYDeg?: undefined;
}

/**
 * A camera file: its bytes, its text, or its parsed JSON. Supported are sim3align's `camera.json`, BOP's
 * `scene_camera.json` (select the entry with `imageId`), ROS CameraInfo, the intrinsics of Open3D and RealSense, and more,
 * which the guide on frames lists.
 */
export type CameraFileInput = EncodedBytes | string | Readonly<Record<string, unknown>>;

/** The supported mesh formats. A PLY file may hold 3D Gaussians, as a `.splat` does. */
export type MeshFormat = "glb" | "gltf" | "obj" | "ply" | "stl" | "splat";

/** A mesh as arrays. */
export interface MeshArrays {
  /** Interleaved x, y, z, in any unit. */
  positions: Float32Array;
  /** Three vertex indices per triangle; without them, every three vertices form a triangle. */
  indices?: Uint32Array | Uint16Array | null | undefined;
  /** Colours, used with a photo: RGB or RGBA per vertex, 0 to 255 or, as floats, 0 to 1. Alpha is ignored. */
  colors?: Uint8Array | Uint8ClampedArray | Float32Array | null | undefined;
  /**
   * The encoding of `colors`: `"srgb"`, the default, as in images and in most programs; or `"linear"`, proportional to
   * light, as in three.js.
   */
  colorSpace?: "srgb" | "linear" | undefined;
  /** Colours at points of the surface, which `readMesh` of `sim3align/formats` makes of textures; instead of `colors`. */
  samples?: ColorSamples | null | undefined;
}

/** A mesh file. */
export interface MeshFile {
  bytes: EncodedBytes;
  /** Detected from the content by default. */
  format?: MeshFormat | undefined;
  /** The files that a glTF, OBJ or PLY file refers to, by the names in it: buffers, textures and material libraries. */
  resources?: Readonly<Record<string, Uint8Array | ArrayBuffer>> | undefined;
  /**
   * What the vertex colours of a glTF are. By default, bytes are sRGB-encoded, and others linear unless a program wrote them that
   * does not convert colours.
   */
  colorSpace?: "srgb" | "linear" | undefined;
}

/**
 * The photo of the view: it shows the field of view of the depth map, pixel for pixel or at another size, sRGB-encoded.
 * Alpha is ignored.
 *
 * - `Uint8Array` of the depth map's size, RGB or RGBA, row-major;
 * - `{ data, width, height }` or an `ImageData`;
 * - the bytes of a photo file (PNG, JPEG or WebP), detected by their signature, turned as their EXIF data say.
 */
export type PhotoInput =
  | Uint8Array
  | Uint8ClampedArray
  | PixelArray<Uint8Array | Uint8ClampedArray>
  | ArrayBuffer
  | BlobLike;

/**
 * The object's mesh, in its own frame: arrays, a mesh file (GLB, glTF, OBJ, PLY, STL or SPLAT; node transforms are applied;
 * of 3D Gaussians in a PLY or SPLAT file, a mesh of their surface is made), or a prepared mesh.
 */
export type MeshInput = MeshArrays | MeshFile | EncodedBytes | PreparedMesh;

/** What a camera saw: a depth map with its camera, or a point map, and the photo, if there is one. */
export type DepthView = {
  /** The photo, which is compared with the colours of the mesh, if it has any. */
  image?: PhotoInput | undefined;
} & (
  | {
      /**
       * The intrinsics of the camera that took the depth map. Without them, they are fitted to a point map. With a depth map,
       * they are those in the depth file, if it has any; otherwise, the focal length is that of the photo's EXIF data, or
       * unknown, and is estimated together with the pose.
       */
      camera?: CameraInput | UnknownCamera | undefined;
      cameraFile?: undefined;
      imageId?: undefined;
    }
  | {
      camera?: undefined;
      /** A camera file, instead of `camera`. It also sets the scale of integer depth, unless `depthScale` is given. */
      cameraFile: CameraFileInput;
      /** The image id in a BOP `scene_camera.json`, or the name of one of several cameras. */
      imageId?: string | number | undefined;
    }
) &
  (
    | (DepthCoding & {
        /**
         * Metres per unit of depth, above 0: 0.001 for millimetres. By default, floats are metres, and integers use the
         * scale of the camera file or, without one, are millimetres.
         */
        depthScale?: number | undefined;
        /**
         * What the values are; `"metric"` by default. For other kinds, the scale and the shift of the depth map are
         * estimated together with the pose, and lengths are metric only if one of the object is known (`scale`,
         * `knownExtentM`): see `depthCalibration` of the result.
         */
        depthKind?: DepthKind | undefined;
        pointMap?: undefined;
      } & (
          | {
              /** The depth map, possibly as a bare array with its size beside it. */
              depth: DepthInput;
              /** Width in pixels. */
              width: number;
              /** Height in pixels. */
              height: number;
            }
          | {
              /** A depth map with its own size. */
              depth: Exclude<DepthInput, DepthNumbers>;
              /** Width in pixels; must match. */
              width?: number | undefined;
              /** Height in pixels; must match. */
              height?: number | undefined;
            }
        ))
    | ({
        /** Whether the points are in metres, the default, or in an unknown unit. */
        depthKind?: "metric" | "scale-invariant" | undefined;
        depth?: undefined;
        depthScale?: undefined;
        depthCode?: undefined;
        depthNear?: undefined;
        depthFar?: undefined;
      } & (
        | {
            /** x, y, z per pixel (height × width × 3), metres, in the OpenCV camera frame: x right, y down, z forward. */
            pointMap: Float32Array | PixelArray<Float32Array>;
            /** Width in pixels. */
            width: number;
            /** Height in pixels. */
            height: number;
          }
        | {
            /** A point map with its own size. */
            pointMap: PixelArray<Float32Array>;
            /** Width in pixels; must match. */
            width?: number | undefined;
            /** Height in pixels; must match. */
            height?: number | undefined;
          }
      ))
  );

/**
 * The input of `align` and `evaluate`: what a camera saw of an object, the mask of the object, and its mesh.
 * `evaluate` measures lengths: it needs a camera, or a point map, and depth without an unknown shift.
 */
export type AlignInput = DepthView & {
  /** The mask of the object. */
  mask: MaskInput;
  /** The mesh to align. */
  mesh: MeshInput;
  /**
   * How to resize a mask whose size differs from that of the depth map. By default, such a mask is an error, and so is one of
   * another shape. A square that SAM padded at the right or below is cropped first.
   */
  resizeMask?: "nearest" | undefined;
  /** The place of the mask in a JSON file of several, from 0. */
  maskIndex?: number | undefined;
};

/** A frame: what a camera saw, and the mask of the object, if it is known. */
export type FrameInput = DepthView & {
  /** The mask of the object, if it is known. */
  mask?: MaskInput | undefined;
  /**
   * How to resize a mask whose size differs from that of the depth map. By default, such a mask is an error, and so is one of
   * another shape. A square that SAM padded at the right or below is cropped first.
   */
  resizeMask?: "nearest" | undefined;
  /** The place of the mask in a JSON file of several, from 0. */
  maskIndex?: number | undefined;
};

/** One of several views of an object. */
export type ViewInput = FrameInput & {
  /**
   * The pose of the camera: world from camera, of scale 1, in metres (camera: x right, y down, z forward). In all views
   * or in none.
   */
  cameraToWorld?: Sim3Like | undefined;
};

/** The input of `alignViews`. */
export interface ViewsInput {
  /** The mesh to align. */
  mesh: MeshInput;
  /** The views: 1 to 64. At least one has a mask; without `cameraToWorld`, all have. */
  views: readonly ViewInput[];
}

/** How the values of a depth map are read. */
export interface ReadDepthOptions extends DepthCoding {
  /** Metres per unit. */
  depthScale?: number | undefined;
  /** Metres per unit of integers, where there is no `depthScale`: that of a camera file. */
  integerDepthScale?: number | undefined;
  /** What the values are; `"metric"` by default. */
  depthKind?: DepthKind | undefined;
}

/**
 * A depth map from a file, row-major: metres along the optical axis, 0 is "no reading". For another `depthKind` than
 * `"metric"`, the values are those of the file; for the affine-invariant kinds, "no reading" is NaN.
 */
export interface DepthImage extends PixelArray<Float32Array> {
  /** The unit of the values in the file. */
  unit: {
    /** Metres per unit; `null` for values whose unit is unknown, or that are no lengths. */
    metres: number | null;
    /**
     * Where the unit comes from: `"depthScale"`, `"camera file"` with the key that states it (`"camera file: factor_depth"`),
     * `"depthCode lerobot"`, `"point map"`, `"float values"`, `"16-bit integers"`; without metres, the kind of depth. The axes of
     * a point map in a file follow, if they are not OpenCV's.
     */
    source: string;
    /** Whether nothing states the unit. */
    isAssumed: boolean;
  };
  /** The camera in the file, in pixels of the depth map: from its intrinsics, focal length or field of view, or from its points. */
  camera?: PinholeCamera;
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
}
