/** Camera files of data sets, drivers and apps. */

import type { PinholeCamera } from "../types/inputs.js";
import { describe, failure, invalidArgument } from "../values/error.js";
import { isNumber, type JsonFile, keysText, parsedJson } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import type { ImageSize } from "../values/pixels.js";
import { cameraText } from "./camera-text.js";
import { checkedPinhole, fromFieldOfView, fromMatrix, type Pinhole, resizedPinhole } from "./pinhole.js";

/** The content of a camera file. */
export interface CameraFile extends PinholeCamera {
  /** Width in pixels of the image that the intrinsics belong to. */
  width?: number;
  /** Height in pixels of the image that the intrinsics belong to. */
  height?: number;
  /** Metres per unit of integer depth. */
  depthScale?: number;
  /** Warnings about lens distortion, which the pinhole model does not include. */
  warnings: string[];
}

/** Options for reading a camera file. */
export interface ReadCameraOptions {
  /** Image width in pixels: required for a field of view, otherwise compared with the width in the file. */
  width?: number | undefined;
  /** Image height in pixels: required for a field of view, otherwise compared with the height in the file. */
  height?: number | undefined;
  /** The image id in a BOP `scene_camera.json`. */
  imageId?: string | number | undefined;
}

/** Longest text of a camera file. */
const MAX_TEXT = 1 << 16;

/** An image size, possibly incomplete. */
interface StatedSize {
  width?: number | undefined;
  height?: number | undefined;
}

/** The names of a camera file and of its options in errors. */
export interface CameraFileNames {
  file: string;
  /** Prefix of the names of options. */
  options: "" | "options.";
}

const forms =
  "{ fx, fy, cx, cy }, { K } or another name of a 3 × 3, 3 × 4 or 4 × 4 matrix, { fovYDeg }, a BOP scene_camera.json, or the numbers as text";

/**
 * Reads a camera file, JSON or text, each with or without the size of the image. Supported forms:
 *
 * | form | written by |
 * |---|---|
 * | `fx`, `fy`, `cx`, `cy`; `ppx`, `ppy`; `fl_x`, `fl_y`; also below `intrinsics` | RealSense, Polycam, nerfstudio |
 * | a matrix of 3 × 3, 3 × 4 or 4 × 4 numbers by rows or by columns: `K`, `cam_K`, `intrinsic(s)`, `camera_matrix`, … | BOP, FoundationPose, VGGT, OpenCV; by columns: Open3D, Record3D, ARKit |
 * | four numbers `fx`, `fy`, `cx`, `cy`, or a bare matrix, as JSON or as text | `K.txt`, `cam_K.txt`, `intrinsics.txt` |
 * | `fovYDeg`, a vertical field of view in degrees, for square pixels; nerfstudio's `camera_angle_x`, radians | |
 * | one entry or all of BOP's `scene_camera.json`, with `imageId` | BOP |
 * | ROS' CameraInfo; OpenCV's YAML; COLMAP's cameras.txt with one camera | |
 *
 * `depthScale` is metres per unit of depth, BOP's `depth_scale` millimetres per unit. Intrinsics for an image of another
 * size but the same shape are scaled.
 */
export function parseCameraFile(
  content: JsonFile,
  { width, height, imageId }: ReadCameraOptions = {},
  names: CameraFileNames = { file: "camera", options: "options." },
): CameraFile {
  const given = { width: side(names, "width", width), height: side(names, "height", height) };
  const id = idOf(names, imageId);
  const json = cameraJson(names.file, content);
  const bare = Array.isArray(json) ? matrixOf(json, names.file) : undefined;
  if (bare !== undefined) return { ...inPixels(bare, sizeOf(given)), warnings: [] };
  if (!isRecord(json)) throw noCamera(names, "JSON that is not an object");
  const entry = sceneEntry(json, id, names) ?? json;
  const own = statedSize(entry);
  const image = sizeOf(given);
  const depthScale = depthScaleOf(entry, names);
  const intrinsics = inPixels(intrinsicsOf(entry, own ?? image, names), own ?? image);
  const scaled =
    own === undefined || image === undefined ? undefined : scaledCamera(names.file, intrinsics, own, image);
  return {
    ...(scaled ?? intrinsics),
    ...(scaled === undefined ? own : image),
    ...(depthScale === undefined ? {} : { depthScale }),
    warnings: isDistorted(entry) ? [distortion] : [],
  };
}

/** The JSON of a camera file, or that with the meaning of its text. */
function cameraJson(argument: string, content: JsonFile): unknown {
  try {
    return parsedJson(argument, content);
  } catch (error) {
    const text = typeof content === "string" ? content : new TextDecoder().decode(content as Uint8Array);
    const read = text.length < MAX_TEXT ? cameraText(text) : undefined;
    if (read === undefined) throw error;
    return read;
  }
}

/**
 * Intrinsics for an image that is `image` instead of `own` pixels large.
 * @throws {@link Sim3AlignError} `SIZE_MISMATCH` for sizes of other shapes: one of the images is cropped
 */
export function scaledCamera(argument: string, camera: Pinhole, own: ImageSize, image: ImageSize): Pinhole {
  const [x, y] = [image.width / own.width, image.height / own.height];
  // Sides are rounded to whole pixels.
  const rounding = 1 / Math.min(own.width, own.height, image.width, image.height);
  if (Math.abs(Math.log(x / y)) <= 2 * rounding) return resizedPinhole(camera, own, image);
  throw failure(
    "SIZE_MISMATCH",
    argument,
    `intrinsics for ${own.width} × ${own.height} pixels, but an image of ${image.width} × ${image.height}`,
    "intrinsics of the same image, or of one of the same shape",
    "Subtract from cx and cy where the crop begins, and leave out width and height.",
  );
}

/** The scale of integer depth in a camera file, if the image size is still unknown. */
export function depthScaleIn(content: JsonFile, imageId?: string | number): number | undefined {
  try {
    // Any size is valid here: only a field of view needs it, and only for the intrinsics.
    const json = cameraJson("camera", content);
    if (!isRecord(json)) return undefined;
    const names: CameraFileNames = { file: "camera", options: "options." };
    return depthScaleOf(sceneEntry(json, idOf(names, imageId), names) ?? json, names);
  } catch {
    // The call with the image size reports the error.
    return undefined;
  }
}

const distortion =
  "The camera has lens distortion, which is not modelled: pass a rectified depth map and mask, and its K.";

/** The entry of a BOP `scene_camera.json`; `null` for any other object. */
function sceneEntry(
  json: Record<string, unknown>,
  id: string | undefined,
  names: CameraFileNames,
): Record<string, unknown> | null {
  const entries = Object.entries(json).filter((pair): pair is [string, Record<string, unknown>] => isRecord(pair[1]));
  if (!entries.some(([, entry]) => "cam_K" in entry)) return null;
  const ids = Object.keys(json);
  // In BOP, ids have no leading zeros, unlike file names.
  const short = (text: string) => text.replace(/^0+/, "");
  const matches = ([key]: [string, unknown]) => key === id || short(key) === short(id ?? "");
  const image = id === undefined ? (ids.length === 1 ? entries[0] : undefined) : entries.find(matches);
  if (image !== undefined) return image[1];
  const sorted = ids.sort((a, b) => a.length - b.length || (a < b ? -1 : 1));
  const more = sorted.length > 20 ? `, … (${sorted.length} in all)` : "";
  const found = id === undefined ? "no image id for a file of several images" : JSON.stringify(id);
  const expected = `one of ${sorted.slice(0, 20).join(", ")}${more}`;
  const remedy = "Pass the id of the image of the depth map.";
  throw failure("INVALID_ARGUMENT", `${names.options}imageId`, found, expected, remedy);
}

/** Names of a matrix of intrinsics, or of an object with them. */
const matrixNames = [
  ...["K", "k", "cam_K", "camera_K", "intrinsic", "intrinsics", "intrinsic_matrix", "intrinsics_matrix"],
  ...["intrinsicMatrix", "camera_matrix", "cameraMatrix", "camera_intrinsic", "camera_intrinsics", "cameraIntrinsics"],
  "color_intrinsics",
];

function intrinsicsOf(entry: Record<string, unknown>, size: ImageSize | undefined, names: CameraFileNames): Pinhole {
  const invalid = (found: string) => noCamera(names, found);
  const matrixName = matrixNames.find((name) => name in entry);
  if (matrixName !== undefined) {
    const matrix = entry[matrixName];
    const numbers = isRecord(matrix) ? matrix.data : matrix;
    if (isRecord(matrix) && numbers === undefined) return intrinsicsOf(matrix, size, names);
    const found = Array.isArray(numbers) ? matrixOf(numbers, names.file) : undefined;
    if (found === undefined) throw invalid(`${matrixName} that is not 3 × 3 numbers`);
    return found;
  }
  const number = (...aliases: string[]): number | undefined => {
    const name = aliases.find((alias) => alias in entry);
    if (name === undefined) return undefined;
    const value = entry[name];
    if (isNumber(value)) return value;
    throw invalid(`${name} that is not a number`);
  };
  const [fx, fy] = [number("fx", "fl_x"), number("fy", "fl_y")];
  const [cx, cy] = [number("cx", "ppx"), number("cy", "ppy")];
  if (fx !== undefined && fy !== undefined && cx !== undefined && cy !== undefined) {
    return checkedPinhole(names.file, { fx, fy, cx, cy });
  }
  const fovYDeg = number("fovYDeg", "fov_y_deg");
  const angleX = number("camera_angle_x");
  if (fovYDeg === undefined && angleX === undefined) throw invalid(`an object with ${keysText(entry)}`);
  if (size !== undefined) {
    if (fovYDeg !== undefined) return fromFieldOfView(names.file, fovYDeg, size);
    const turned = { width: size.height, height: size.width };
    const { fx: f } = fromFieldOfView(names.file, ((angleX as number) * 180) / Math.PI, turned);
    return { fx: f, fy: f, cx: 0.5 * (size.width - 1), cy: 0.5 * (size.height - 1) };
  }
  const remedy = "Pass the width and height of the depth map in pixels.";
  const found = "a field of view without image size";
  throw failure("INVALID_ARGUMENT", `${names.options}width`, found, "width and height", remedy);
}

/** The intrinsics in four numbers, or in a matrix by rows or by columns; `undefined` for anything else. */
function matrixOf(value: readonly unknown[], file: string): Pinhole | undefined {
  const numbers: unknown[] = value.flat(3);
  if (!numbers.every(isNumber)) return undefined;
  if (numbers.length === 4) {
    const [fx, fy, cx, cy] = numbers;
    return checkedPinhole(file, { fx, fy, cx, cy });
  }
  // By columns, what is a row here is a column.
  const columns = { 9: 3, 12: Array.isArray(value[0]) && value.length !== 3 ? undefined : 4, 16: 4 }[numbers.length];
  if (columns === undefined) return undefined;
  const square = [0, 1, 2].flatMap((row) => [0, 1, 2].map((column) => numbers[columns * row + column] as number));
  const transposed = [0, 3, 6, 1, 4, 7, 2, 5, 8].map((i) => square[i] as number);
  const isByColumns = (square[6] !== 0 || square[7] !== 0) && square[2] === 0 && square[5] === 0;
  return fromMatrix(file, isByColumns ? transposed : square);
}

/** Largest principal point and focal length of intrinsics in image sizes; those in pixels are larger. */
const maxNormalised = { center: 2, focal: 20 } as const;

/** Intrinsics in pixels. Those in image sizes, as MoGe writes them, count from the outer edge of the first pixel. */
function inPixels({ fx, fy, cx, cy }: Pinhole, size: ImageSize | undefined): Pinhole {
  const isNormalised = Math.max(cx, cy) < maxNormalised.center && Math.max(fx, fy) < maxNormalised.focal;
  if (!isNormalised || size === undefined) return { fx, fy, cx, cy };
  const { width, height } = size;
  return { fx: fx * width, fy: fy * height, cx: cx * width - 0.5, cy: cy * height - 0.5 };
}

/** The error for JSON that is not the content of a camera file. */
function noCamera({ file }: CameraFileNames, found: string) {
  const remedy = "Write the focal lengths and the principal point as fx, fy, cx and cy, in pixels of the depth map.";
  return failure("INVALID_CAMERA", file, found, forms, remedy);
}

function depthScaleOf({ depthScale, depth_scale }: Record<string, unknown>, names: CameraFileNames) {
  if (depthScale === undefined && depth_scale === undefined) return undefined;
  const fromBop = isNumber(depth_scale) ? depth_scale / 1000 : depth_scale;
  const scale = depthScale === undefined ? fromBop : depthScale;
  if (isNumber(scale) && scale > 0) return scale;
  const remedy = "Write metres per unit as depthScale, or BOP's millimetres per unit as depth_scale.";
  const found = "a depth scale that is not a number above 0";
  throw failure("INVALID_CAMERA", `${names.file}.depthScale`, found, "a number above 0", remedy);
}

function isDistorted({ D, d = D }: Record<string, unknown>): boolean {
  const coefficients = D ?? d;
  return Array.isArray(coefficients) && coefficients.some((number) => isNumber(number) && number !== 0);
}

const wholeIn = (value: unknown) =>
  Number.isSafeInteger(value) && (value as number) >= 0 ? (value as number) : undefined;

/** The size of the image that the intrinsics belong to, if the file states it. */
function statedSize(entry: Record<string, unknown>): ImageSize | undefined {
  const nested = matrixNames.map((name) => entry[name]).find(isRecord);
  const of = (...aliases: string[]) =>
    [entry, nested ?? {}].flatMap((object) => aliases.map((name) => wholeIn(object[name]))).find((value) => value);
  return sizeOf({ width: of("width", "w", "image_width"), height: of("height", "h", "image_height") });
}

const sizeOf = ({ width, height }: StatedSize): ImageSize | undefined =>
  width === undefined || height === undefined ? undefined : { width, height };

function side({ options }: CameraFileNames, name: string, value: unknown): number | undefined {
  if (value === undefined || value === null || wholeIn(value) !== undefined) return wholeIn(value);
  throw failure("INVALID_ARGUMENT", `${options}${name}`, describe(value), "an integer", "Pass the size in pixels.");
}

function idOf({ options }: CameraFileNames, imageId: unknown): string | undefined {
  if (imageId === undefined || imageId === null) return undefined;
  if (typeof imageId === "number" || typeof imageId === "string") return `${imageId}`;
  throw invalidArgument(`${options}imageId`, imageId, "a string or a number", "Pass a key of the file.");
}
