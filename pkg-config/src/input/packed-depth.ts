/** 8-bit pictures whose channels are the bytes of one number. Loaded only where one is passed as a depth map. */

import type { DepthCode, DepthImage } from "../types/inputs.js";
import { failure, Sim3AlignError } from "../values/error.js";
import { depthCodes, passingCode } from "./depth-codes.js";

/** Pixels that are looked at. */
const SAMPLES = 1 << 16;

/** Differences of neighbours: the first byte of a number is smooth, the last one is not. Of pictures, all channels are as smooth. */
const SMOOTH = 4;
const ROUGH = 8;

/**
 * The error for an 8-bit picture, which says so if its channels are the bytes of one number.
 * @param read the bytes of each pixel as one number, red the lowest, or the floats that they are
 */
export async function explained(error: unknown, read: () => Promise<DepthImage>): Promise<unknown> {
  if (!(error instanceof Sim3AlignError) || error.code !== "EIGHT_BIT_DEPTH") return error;
  const { data, width } = await read();
  const name = packedCode(data, width);
  if (name === undefined) return error;
  const { writers, formula } = depthCodes[name];
  const found = `an 8-bit PNG whose channels are the bytes of one number, as ${writers} write them (${formula})`;
  const remedy = passingCode(name).replace("pass", "Pass");
  return failure("EIGHT_BIT_DEPTH", error.argument, found, "one 16-bit channel, or a code", remedy, error);
}

function packedCode(values: Float32Array, width: number): DepthCode | undefined {
  const differences = [0, 0, 0];
  let [count, floats] = [0, 0];
  const step = Math.ceil(values.length / SAMPLES) | 1;
  for (let i = 1; i < values.length; i += step) {
    const [before, value] = [values[i - 1] as number, values[i] as number];
    // Walls that are alike say nothing.
    if (i % width === 0 || before === value || !(before > 0 && value > 0)) continue;
    count += 1;
    floats += Number(!Number.isInteger(value));
    for (const [k] of differences.entries())
      differences[k] = (differences[k] as number) + Math.abs(((value >> (8 * k)) & 255) - ((before >> (8 * k)) & 255));
  }
  if (floats > count / 2) return "rgba-float";
  const [red = 0, , blue = 0] = differences.map((sum) => sum / count);
  if (red < SMOOTH && blue > ROUGH && blue > 4 * red) return "rlbench";
  return blue < SMOOTH && red > ROUGH && red > 4 * blue ? "carla" : undefined;
}
