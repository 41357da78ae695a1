/** Depth in metres from the codes in which programs store it. */
import { decodedDepth } from "../input/depth-codes.js";
import { depthCodeNames } from "../input/formats.js";
import type { DepthCode, DepthCoding } from "../types/inputs.js";
import { type PixelArray, pixelsOf } from "../values/pixels.js";
import { oneOf, optionsOf } from "../values/validation.js";

/**
 * The depth along the optical axis in metres, from the numbers of a code; 0 where there is no reading. `align` and `readDepth`
 * take a code as `depthCode`; this is for other uses.
 * @param codes 24 bits of three channels as red + 256 · green + 65536 · blue
 * @param code the name of the code; the guide on frames has their formulas
 * @param range `depthNear` and `depthFar` in metres, for codes that need them
 *
 * @example
 * const metres = depthFromCode(buffer, "z-buffer", { depthNear: 0.01, depthFar: 10 });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, unknown codes, and a missing range
 */
export function depthFromCode(
  codes: PixelArray<Float32Array | Uint16Array>,
  code: DepthCode,
  range: Pick<DepthCoding, "depthNear" | "depthFar"> = {},
): PixelArray<Float32Array> {
  const { data, width, height } = pixelsOf<Float32Array>("codes", codes, ["Float32Array", "Uint16Array"]);
  const name = oneOf("code", code, depthCodeNames, "INVALID_ARGUMENT");
  return { data: decodedDepth(data, name, optionsOf(range, ["depthNear", "depthFar"])), width, height };
}
