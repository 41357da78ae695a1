/** Converts depth maps and point maps to arrays with their size. */

import type { Pinhole } from "../camera/pinhole.js";
import type { FileReaders } from "../modules/readers.js";
import type { DepthImage, DepthKind, ReadDepthOptions } from "../types/inputs.js";
import { failure, invalidArgument } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import { oneOf, positive, withoutUndefined, wrongKind } from "../values/validation.js";
import { callReader, fileBytes, isBytes } from "./bytes.js";
import { depthCodeNames, formatsText, isAffineInvariant } from "./formats.js";

/** A depth map or a point map for the core. */
export interface SizedArray<T> {
  data: T;
  width: number | undefined;
  height: number | undefined;
}

type DepthArray = Float32Array | Uint16Array;

/** Metres per unit of integer depth of which nothing else is known. */
export const DEFAULT_SCALE = 0.001;

/** A depth map for the core, with the camera and the unit in its file. */
export interface ReadDepth extends SizedArray<DepthArray> {
  /** The camera in the file. */
  camera?: Pinhole;
  /** The unit of the values. */
  unit: DepthImage["unit"];
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
}

const depthForms = () =>
  `a Float32Array (metres), a Uint16Array (with depthScale), { data, width, height } of these, or the bytes of a file: ${formatsText("depth")}`;

/** How a file is read: also the channels of a picture as the bytes of one number. */
type FileReading = ReadDepthOptions & { isPacked?: true };

/** The image size in the input, if given. */
export interface StatedSize {
  width?: number | undefined;
  height?: number | undefined;
}

/**
 * The values of a depth map: metres for files and floats, units of `depthScale` for integers; for other kinds than metric
 * depth, the values themselves.
 */
export async function readDepth(
  depth: unknown,
  size: StatedSize,
  reading: FileReading,
  readers: FileReaders,
): Promise<ReadDepth> {
  if (reading.depthCode !== undefined) return decoded(reading, (raw) => readDepth(depth, size, raw, readers));
  const ofArray = <T extends SizedArray<DepthArray>>(read: T) => ({ ...read, unit: unitOf(read.data, reading) });
  if (isDoubles(depth)) return ofArray({ data: Float32Array.from(depth), ...required(size) });
  if (isDepthArray(depth)) return ofArray({ data: depth, ...required(size) });
  const mayHaveBytes = isAffineInvariant(reading.depthKind);
  if (isRecord(depth) && "data" in depth) {
    const { data } = depth;
    const isConverted = isDoubles(data) || (mayHaveBytes && isBytes(data));
    const values = isConverted ? { ...depth, data: Float32Array.from(data) } : depth;
    return ofArray(sized("depth", values, depthForms(), isDepthArray, size));
  }
  const bytes = await fileBytes("depth", depth);
  if (bytes === null) throw wrongKind("depth", depth, depthForms(), "Float32Array");
  if (bytes === depth && bytes.length === (size.width ?? 0) * (size.height ?? 0) && bytes.length > 0) {
    if (mayHaveBytes) return ofArray({ data: Float32Array.from(bytes), ...required(size) });
    const found = `a Uint8Array of ${size.width} × ${size.height} values`;
    const remedy =
      'Pass the depth map itself: 256 levels are a visualisation of it. If a relative model drew it, near is bright: pass depthKind "affine-invariant-disparity".';
    throw failure("EIGHT_BIT_DEPTH", "depth", found, depthForms(), remedy);
  }
  const file = await decodeDepth("depth", bytes, reading, readers, (argument) => argument.replace(/^options\./, ""));
  checkStatedSize("depth", file, size);
  return file;
}

/** Reads the numbers of a code, and decodes them. */
async function decoded<T extends { data: DepthArray; unit: DepthImage["unit"] }>(
  { depthCode, depthNear, depthFar, depthScale = 1, depthKind }: ReadDepthOptions,
  read: (raw: FileReading) => Promise<T>,
): Promise<T & { data: Float32Array }> {
  const name = oneOf("depthCode", depthCode, depthCodeNames, "INVALID_ARGUMENT");
  const scale = positive("depthScale", depthScale);
  const { decodedDepth } = await import("./depth-codes.js");
  const codes = await read({ depthScale: 1, isPacked: true });
  const data = decodedDepth(codes.data, name, { depthNear, depthFar }).map((metres) => metres * scale);
  const unit = { metres: scale, source: `depthCode ${name}`, isAssumed: false };
  const hasUnit = depthKind === undefined || depthKind === "metric" || depthKind === "ray-distance";
  return { ...codes, data, unit: hasUnit ? unit : unknownUnit(depthKind) };
}

/** Metres per unit of the depth of a view: of floats without a scale, 1. */
export const metresPerUnit = (depth: unknown, scale: unknown): number =>
  typeof scale === "number" ? scale : isTypedArray(depth, "Float32Array", "Float64Array") ? 1 : DEFAULT_SCALE;

/** The unit of an array, in the words of the readers of files. */
function unitOf(
  data: DepthArray,
  { depthKind = "metric", depthScale, integerDepthScale }: ReadDepthOptions,
): DepthImage["unit"] {
  if (isAffineInvariant(depthKind) || depthKind === "scale-invariant") return unknownUnit(depthKind);
  // The core refuses anything else than a number.
  if (typeof depthScale === "number") return { metres: depthScale, source: "depthScale", isAssumed: false };
  if (isFloats(data)) return { metres: 1, source: "float values", isAssumed: true };
  return typeof integerDepthScale === "number"
    ? { metres: integerDepthScale, source: "camera file", isAssumed: false }
    : { metres: DEFAULT_SCALE, source: "16-bit integers", isAssumed: true };
}

/** The unit of values of a kind that has none. */
export const unknownUnit = (depthKind: DepthKind) => ({ metres: null, source: depthKind, isAssumed: false });

/** Signatures of the files of depth models: NPZ (also without an array), OpenEXR, TIFF and PFM. */
const ofDepthModels = [
  ...[
    "PK\x03\x04",
    "PK\x05\x06",
    "v/1\x01",
    "II*\0",
    "MM\0*",
    "II+\0",
    "MM\0+",
    "Pf\n",
    "PF\n",
    "Pf\r",
    "PF\r",
    "Pf ",
    "PF ",
  ],
];

/** Whether an array has more than two axes longer than 1: the same module reads point maps. */
function hasPoints(bytes: Uint8Array): boolean {
  if (bytes[0] !== 0x93 || bytes[1] !== 0x4e) return false;
  const [, shape = ""] = /'shape':\s*\(([^)]*)\)/.exec(String.fromCharCode(...bytes.subarray(0, 512))) ?? [];
  return shape.split(",").filter((side) => Number.parseInt(side, 10) > 1).length > 2;
}

/**
 * Reads a depth map of any supported format by the module for that format.
 * @param argument the name of the bytes, in errors
 * @param rename of the arguments in errors of the reader
 */
export async function decodeDepth(
  argument: string,
  bytes: Uint8Array,
  reading: FileReading,
  readers: FileReaders,
  rename?: (argument: string) => string,
): Promise<DepthImage> {
  if (reading.depthCode !== undefined)
    return decoded(reading, (raw) => decodeDepth(argument, bytes, raw, readers, rename));
  // Distances along rays are read like other lengths; converting them needs the camera.
  const { depthKind, depthScale, integerDepthScale, isPacked } = reading;
  const kind = depthKind === "ray-distance" ? undefined : depthKind;
  const options = withoutUndefined({ depthScale, integerDepthScale, isPacked, depthKind: kind });
  const beginning = String.fromCharCode(...bytes.subarray(0, 4));
  if (ofDepthModels.some((magic) => beginning.startsWith(magic)) || hasPoints(bytes)) {
    return callReader(readers.depthFiles, argument, bytes, (module) => module.readDepthFile(bytes, options), rename);
  }
  const read = (packed: object = options) =>
    callReader(readers.formats, argument, bytes, (module) => module.readDepth(bytes, packed), rename);
  if (isPacked || !isColourPng(bytes)) return read();
  return read().catch(async (error) => {
    const { explained } = await import("./packed-depth.js");
    throw await explained(error, () => read({ depthScale: 1, isPacked: true }));
  });
}

/** Whether a file is a PNG of 8 bits in red, green and blue, perhaps with alpha. */
const isColourPng = (bytes: Uint8Array): boolean =>
  bytes[1] === 0x50 && bytes[24] === 8 && (bytes[25] === 2 || bytes[25] === 6);

/** The values of a point map, in metres. */
export function readPointMap(pointMap: unknown, size: StatedSize): SizedArray<Float32Array> {
  const kinds = "a Float32Array of height × width × 3 values (metres), or { data, width, height } with one";
  if (isFloats(pointMap)) return { data: pointMap, ...required(size) };
  if (isRecord(pointMap) && "data" in pointMap) return sized("pointMap", pointMap, kinds, isFloats, size);
  throw wrongKind("pointMap", pointMap, kinds, "Float32Array");
}

const isFloats = (value: unknown): value is Float32Array => isTypedArray(value, "Float32Array");
const isDoubles = (value: unknown): value is Float64Array => isTypedArray(value, "Float64Array");
const isDepthArray = (value: unknown): value is DepthArray => isTypedArray(value, "Float32Array", "Uint16Array");

const required = ({ width, height }: StatedSize) => ({ width, height });

function sized<T>(
  argument: string,
  image: Record<string, unknown>,
  kinds: string,
  isData: (value: unknown) => value is T,
  stated: StatedSize,
): SizedArray<T> {
  checkSides(`${argument}.`, image);
  const { data, width, height } = image as { data: unknown; width: number; height: number };
  if (!isData(data)) throw wrongKind(`${argument}.data`, data, kinds, "Float32Array");
  checkStatedSize(argument, { width, height }, stated);
  return { data, width, height };
}

/** Checks the types of a size. The core checks the numbers. */
export function checkSides(prefix: string, size: { width?: unknown; height?: unknown }): void {
  for (const name of ["width", "height"] as const) {
    const side = size[name];
    if (side === undefined || side === null || typeof side === "number") continue;
    throw invalidArgument(`${prefix}${name}`, side, "an integer in pixels", "Pass the image size in pixels.");
  }
}

function checkStatedSize(argument: string, actual: { width: number; height: number }, stated: StatedSize): void {
  const { width = actual.width, height = actual.height } = stated;
  if (width === actual.width && height === actual.height) return;
  const expected = `${width} × ${height}, the width and height of the input`;
  const remedy = `Omit width and height: ${argument} has its own.`;
  throw failure("SIZE_MISMATCH", argument, `${actual.width} × ${actual.height} pixels`, expected, remedy);
}
