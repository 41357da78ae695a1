/** Camera files of data sets and drivers: sim3align, BOP, ROS, RealSense and Open3D. */

import type { PinholeCamera } from "../input/types.js";
import { describe, failure, invalidArgument } from "../values/error.js";
import { isRecord } from "../values/values.js";
import { isNumber, type JsonFile, namesIn, numbersIn, parsedJson } from "./json.js";
import { checkedPinhole, fromFieldOfView, fromMatrix, type Pinhole } from "./pinhole.js";
import type { ImageSize } from "./pixels.js";

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

/** An image size, possibly incomplete. */
interface StatedSize {
  width?: number | undefined;
  height?: number | undefined;
}

/** Names of a camera file and of its options, for errors. */
export interface CameraFileNames {
  file: string;
  /** Prefix of the names of options. */
  options: "" | "options.";
}

const forms = "{ fx, fy, cx, cy }, { K }, { fovYDeg }, intrinsic_matrix, a BOP scene_camera.json or a ROS CameraInfo";

/**
 * Reads a camera file. Supported forms, each with or without `width` and `height`:
 *
 * - `{ fx, fy, cx, cy }`, with RealSense's `ppx`, `ppy` too; `depthScale` is metres per unit of depth, BOP's
 *   `depth_scale` millimetres per unit;
 * - `{ K }`, nine numbers (row-major) or three rows; or the bare array;
 * - Open3D's `intrinsic_matrix`, column-major;
 * - `{ fovYDeg }`, a vertical field of view in degrees, for square pixels;
 * - BOP's `scene_camera.json`, and one entry of it (`cam_K`);
 * - ROS' CameraInfo (`K` and `D`, or `k` and `d`).
 */
export function parseCameraFile(
  content: JsonFile,
  { width, height, imageId }: ReadCameraOptions = {},
  names: CameraFileNames = { file: "camera", options: "options." },
): CameraFile {
  const given = { width: side(names, "width", width), height: side(names, "height", height) };
  const id = idOf(names, imageId);
  const json = parsedJson(names.file, content);
  if (numbersIn(json, 9) !== null) return { ...fromMatrix(names.file, json), warnings: [] };
  if (!isRecord(json)) throw noCamera(names, "JSON that is not an object");
  const entry = sceneEntry(json, id, names) ?? json;
  const own = { width: wholeIn(entry.width), height: wholeIn(entry.height) };
  checkCameraSize(names.file, own, given);
  const depthScale = depthScaleOf(entry, names);
  return {
    ...intrinsicsOf(entry, sizeOf(own) ?? sizeOf(given), names),
    ...(own.width === undefined ? {} : { width: own.width }),
    ...(own.height === undefined ? {} : { height: own.height }),
    ...(depthScale === undefined ? {} : { depthScale }),
    warnings: isDistorted(entry) ? [distortion] : [],
  };
}

/** The scale of integer depth in a camera file, if the image size is still unknown. */
export function depthScaleIn(content: JsonFile, imageId?: string | number): number | undefined {
  try {
    // Any size is valid here: only a field of view needs it, and only for the intrinsics.
    const json = parsedJson("camera", content);
    if (!isRecord(json)) return undefined;
    const names: CameraFileNames = { file: "camera", options: "options." };
    return depthScaleOf(sceneEntry(json, idOf(names, imageId), names) ?? json, names);
  } catch {
    // The call with the image size reports the error.
    return undefined;
  }
}

/** Rejects intrinsics for an image of another size, if both sizes are known. */
export function checkCameraSize(argument: string, own: StatedSize, image: StatedSize): void {
  if (image.width === undefined || image.height === undefined) return;
  const { width = image.width, height = image.height } = own;
  if (width === image.width && height === image.height) return;
  throw failure(
    "SIZE_MISMATCH",
    argument,
    `intrinsics for ${width} × ${height} pixels, but an image of ${image.width} × ${image.height}`,
    "intrinsics of the same image",
    "Scale fx, cx by the ratio of the widths and fy, cy by that of the heights, or pass the full-size depth.",
  );
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

function intrinsicsOf(entry: Record<string, unknown>, size: ImageSize | undefined, names: CameraFileNames): Pinhole {
  const invalid = (found: string) => noCamera(names, found);
  const matrixName = ["K", "k", "cam_K"].find((name) => name in entry);
  if (matrixName !== undefined) {
    const K = numbersIn(entry[matrixName], 9);
    if (K === null) throw invalid(`${matrixName} that is not 3 × 3 numbers`);
    return fromMatrix(names.file, K);
  }
  if ("intrinsic_matrix" in entry) {
    const columns = numbersIn(entry.intrinsic_matrix, 9);
    if (columns === null) throw invalid("intrinsic_matrix that is not 9 numbers");
    return fromMatrix(
      names.file,
      [0, 3, 6, 1, 4, 7, 2, 5, 8].map((i) => columns[i]),
    );
  }
  const number = (...aliases: string[]): number | undefined => {
    const name = aliases.find((alias) => alias in entry);
    if (name === undefined) return undefined;
    const value = entry[name];
    if (isNumber(value)) return value;
    throw invalid(`${name} that is not a number`);
  };
  const [fx, fy, cx, cy] = [number("fx"), number("fy"), number("cx", "ppx"), number("cy", "ppy")];
  if (fx !== undefined && fy !== undefined && cx !== undefined && cy !== undefined) {
    return checkedPinhole(names.file, { fx, fy, cx, cy });
  }
  const fovYDeg = number("fovYDeg", "fov_y_deg");
  if (fovYDeg === undefined) throw invalid(`an object with ${namesIn(entry)}`);
  if (size !== undefined) return fromFieldOfView(names.file, fovYDeg, size);
  const remedy = "Pass the width and height of the depth map in pixels.";
  const found = "a field of view without image size";
  throw failure("INVALID_ARGUMENT", `${names.options}width`, found, "width and height", remedy);
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
