/** Whether the numbers of a depth map look like a code, and no lengths. */

import type { Warning } from "../generated/types.js";
import type { DepthCode, DepthImage } from "../types/inputs.js";
import type { StatedSize } from "./depth.js";

/** Values that are looked at. */
const SAMPLES = 1 << 14;

/** Values of which fewer say nothing about a code, and the most that are told apart. */
const DISTINCT = [32, 1024] as const;

/** What the readings of a depth map are, as they were stored. */
interface Facts {
  /** Whether all are whole numbers. */
  isWhole: boolean;
  /** Whether nothing states the unit. */
  isAssumed: boolean;
  /** Whether a unit is a millimetre. */
  isMillimetres: boolean;
  least: number;
  most: number;
  mean: number;
  /** The share of multiples of 8, and that of multiples of 16 among the values that differ. */
  eights: number;
  sixteens: number;
}

/** How the numbers betray each code. */
const signs: { readonly [K in DepthCode]?: (facts: Facts) => boolean } = {
  // Of sensors that round, half of the multiples of 8 are multiples of 16 as well; other units have other divisors.
  "sun-rgbd": ({ isWhole, isMillimetres, eights, sixteens }) =>
    isWhole && isMillimetres && eights > 0.95 && sixteens < 0.8,
  // 11 to 23 m, if they were millimetres.
  "half-float": ({ isWhole, isAssumed, least, most }) => isWhole && isAssumed && least >= 0x2c00 && most <= 0x5c00,
  // Most maps in millimetres are such numbers, and planes tell; so they do of a scene within one metre of the camera.
  lerobot: ({ isWhole, isAssumed, most }) => isWhole && isAssumed && most <= 4095,
  behavior: ({ isWhole, isAssumed, most }) => isWhole && isAssumed && most <= 16383,
  "z-buffer": ({ isWhole, isAssumed, mean, most }) => !isWhole && isAssumed && mean >= 0.7 && most <= 1,
};

/** A warning about a code, and whether it is only for a pose in doubt. */
export interface CodeDoubt {
  warning: Warning;
  isUncertain: boolean;
}

/** The code that the values of a metric depth map look like. */
export async function doubtOfCode(
  values: Float32Array | Uint16Array,
  { width = 0, height = 0 }: StatedSize,
  unit: DepthImage["unit"],
): Promise<CodeDoubt | undefined> {
  const facts = factsOf(values, unit);
  const names = (Object.keys(signs) as DepthCode[]).filter((code) => facts !== undefined && signs[code]?.(facts));
  if (facts === undefined || names.length === 0) return undefined;
  const { codeTest, depthCodes, passingCode } = await import("./depth-codes.js");
  const { metres } = unit;
  const isStored = values instanceof Uint16Array || metres === 1 || metres === null;
  const storedAt = (i: number) => (isStored ? (values[i] as number) : Math.round((values[i] as number) / metres));
  const isCoded = codeTest(storedAt, { width, height }, facts);
  for (const name of names) {
    const certainty = isCoded(name);
    if (certainty === false) continue;
    const { writers, formula, signs: betrayed } = depthCodes[name];
    const message = `The values of the depth map look like a code of ${writers}, and no lengths: ${betrayed}. If they are (${formula}), ${passingCode(name)}`;
    return { warning: { code: "DEPTH_LOOKS_CODED", message }, isUncertain: certainty === undefined };
  }
  return undefined;
}

function factsOf(values: Float32Array | Uint16Array, { metres, isAssumed }: DepthImage["unit"]): Facts | undefined {
  // The readers of files have multiplied them by the unit.
  const scale = metres === null || values instanceof Uint16Array ? 1 : metres;
  const step = Math.ceil(values.length / SAMPLES) | 1;
  const distinct = new Set<number>();
  let [count, sum, least, most, eights, wholes] = [0, 0, Number.POSITIVE_INFINITY, 0, 0, 0];
  for (let i = 0; i < values.length; i += step) {
    const exact = (values[i] as number) / scale;
    // No reading, or no number.
    if (!(exact > 0)) continue;
    const value = Math.abs(exact - Math.round(exact)) < 0.01 && scale < 1 ? Math.round(exact) : exact;
    count += 1;
    sum += value;
    [least, most] = [Math.min(least, value), Math.max(most, value)];
    wholes += Number(Number.isInteger(value));
    // No code has fractions and values above 1.
    if (wholes < count && most > 1) return undefined;
    eights += Number(value % 8 === 0);
    if (distinct.size < DISTINCT[1]) distinct.add(value);
  }
  if (distinct.size < DISTINCT[0]) return undefined;
  const isMillimetres = metres !== null && Math.abs(metres - 0.001) < 1e-6;
  const sixteens = [...distinct].filter((value) => value % 16 === 0).length / distinct.size;
  const shares = { eights: eights / count, sixteens };
  return { isWhole: wholes === count, isAssumed, isMillimetres, least, most, mean: sum / count, ...shares };
}
