/** Parsers for flag values. Invalid values are usage errors. */
import { InvalidArgumentError } from "commander";
import { MAX_WORKERS } from "../aligner/aligner-options.js";
import type { CameraInput, ScaleOption, SymmetryOption } from "../index.js";
import { isRecord } from "../values/kinds.js";

/** Parses a number. */
export function number(text: string): number {
  const value = Number(text);
  if (text.trim() === "" || Number.isNaN(value)) throw new InvalidArgumentError("Not a number.");
  return value;
}

/** Parses a number above 0. */
export function positive(text: string): number {
  const value = number(text);
  if (value > 0 && Number.isFinite(value)) return value;
  throw new InvalidArgumentError("Expected a number above 0.");
}

/** Parses a whole number above 0. */
export function count(text: string): number {
  const value = number(text);
  if (value >= 1 && Number.isSafeInteger(value)) return value;
  throw new InvalidArgumentError("Expected a whole number, 1 or more.");
}

/** Parses the number of workers. */
export function workers(text: string): number | "auto" {
  if (text === "auto") return text;
  const value = /^\d+$/.test(text) ? Number(text) : 0;
  if (value < 1 || value > MAX_WORKERS) throw new InvalidArgumentError(`Expected 1 to ${MAX_WORKERS}, or "auto".`);
  return value;
}

/** The numbers of a text with commas. */
const valuesOf = (text: string) => text.split(",").map((part) => (part.trim() === "" ? Number.NaN : Number(part)));

/** Parses comma-separated numbers, as many as one of the counts says. */
function numbers(text: string, counts: readonly number[], expected: string): number[] {
  const values = valuesOf(text);
  if (counts.includes(values.length) && !values.some(Number.isNaN)) return values;
  throw new InvalidArgumentError(`Found ${values.length} values, expected ${expected}.`);
}

/** Parses MIN,MAX or `none`. (Commander treats null as a missing value.) */
export const guard = (text: string) =>
  text === "none" ? text : (numbers(text, [2], 'MIN,MAX, such as 0.5,1.5, or "none"') as [number, number]);

/** Parses X,Y,Z. */
export const direction = (text: string) => numbers(text, [3], "X,Y,Z, such as 0,-1,0") as [number, number, number];

/** Parses `free`, a number, or MIN,MAX. */
export function scale(text: string): ScaleOption {
  if (text === "free") return text;
  const [value = 0, max] = numbers(text, [1, 2], '"free", a number, such as 0.001, or MIN,MAX');
  return max === undefined ? value : [value, max];
}

/** Parses a name, which the core checks, or a JSON array of axes. */
export function symmetry(text: string): SymmetryOption {
  return text.trimStart().startsWith("[") ? (json(text) as SymmetryOption) : (text as "auto");
}

function json(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new InvalidArgumentError(`Invalid JSON: ${(error as Error).message}.`);
  }
}

/** Parses a JSON object. */
export function jsonObject(text: string): Record<string, unknown> {
  const value = json(text);
  if (isRecord(value)) return value;
  throw new InvalidArgumentError('Expected an object, such as {"ransacIterations": 200000}.');
}

/** Parses fx,fy,cx,cy or fov:DEGREES; anything else is a file. */
export function camera(text: string): string | { value: CameraInput } {
  // Two numbers or more are no name of a file.
  if (valuesOf(text).filter((value) => !Number.isNaN(value)).length >= 2) {
    const expected = "four numbers: fx,fy,cx,cy in pixels, such as 600,600,319.5,239.5";
    const [fx = 0, fy = 0, cx = 0, cy = 0] = numbers(text, [4], expected);
    if (fx > 0 && fy > 0) return { value: { fx, fy, cx, cy } };
    throw new InvalidArgumentError("Expected focal lengths above 0: fx,fy,cx,cy in pixels.");
  }
  if (!text.startsWith("fov:")) return text;
  const fovYDeg = number(text.slice("fov:".length));
  if (fovYDeg > 0 && fovYDeg < 180) return { value: { fovYDeg } };
  throw new InvalidArgumentError("Expected a vertical field of view above 0 and below 180 degrees.");
}
