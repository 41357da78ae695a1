/** Converts depth maps and point maps to arrays with their size. */
import { failure, invalidArgument } from "../error.js";
import type { LoadFormats } from "../formats-module.js";
import { isRecord, isTypedArray, withoutUndefined, wrongKind } from "../values.js";
import { callReader, fileBytes } from "./bytes.js";

/** A depth map or a point map for the core. */
export interface SizedArray<T> {
  data: T;
  width: number | undefined;
  height: number | undefined;
}

type DepthArray = Float32Array | Uint16Array;

const depthKinds =
  "a Float32Array (metres), a Uint16Array (with depthScale), { data, width, height } of these, or the bytes of a 16-bit PNG or a .npy file";

/** The image size in the input, if given. */
export interface StatedSize {
  width?: number | undefined;
  height?: number | undefined;
}

/**
 * The values of a depth map: metres for files and floats, units of `depthScale` for integers.
 * @param scale `depthScale` of the caller or, for integers only, of the camera file
 */
export async function readDepth(
  depth: unknown,
  size: StatedSize,
  scale: { depthScale: number | undefined; integerDepthScale: number | undefined },
  formats: LoadFormats,
): Promise<SizedArray<DepthArray>> {
  if (isDepthArray(depth)) return { data: depth, ...required(size) };
  if (isRecord(depth) && "data" in depth) return sized("depth", depth, depthKinds, isDepthArray, size);
  const bytes = await fileBytes("depth", depth);
  if (bytes === null) throw wrongKind("depth", depth, depthKinds, "Float32Array");
  if (bytes === depth && bytes.length === (size.width ?? 0) * (size.height ?? 0) && bytes.length > 0) {
    const found = `a Uint8Array of ${size.width} × ${size.height} values`;
    const remedy = "256 levels are a visualisation of depth: pass the depth map itself.";
    throw failure("EIGHT_BIT_DEPTH", "depth", found, depthKinds, remedy);
  }
  const file = await callReader(
    formats,
    "depth",
    bytes,
    (readers) => readers.readDepth(bytes, withoutUndefined(scale)),
    (argument) => argument.replace(/^options\./, ""),
  );
  checkStatedSize("depth", file, size);
  return file;
}

/** The values of a point map, in metres. */
export function readPointMap(pointMap: unknown, size: StatedSize): SizedArray<Float32Array> {
  const kinds = "a Float32Array of height × width × 3 values (metres), or { data, width, height } with one";
  if (isFloats(pointMap)) return { data: pointMap, ...required(size) };
  if (isRecord(pointMap) && "data" in pointMap) return sized("pointMap", pointMap, kinds, isFloats, size);
  throw wrongKind("pointMap", pointMap, kinds, "Float32Array");
}

const isFloats = (value: unknown): value is Float32Array => isTypedArray(value, "Float32Array");
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
