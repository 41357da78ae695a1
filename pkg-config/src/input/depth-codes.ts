/**
 * Codes in which programs store depth: numbers that are no multiples of a length. Loaded only where a code is stated, or where
 * the numbers look like one; what decides that is in `coded-depth.ts`.
 */
import type { DepthCode } from "../types/inputs.js";
import { invalidArgument } from "../values/error.js";
import { finite } from "../values/validation.js";

/** A code of depth. */
interface Code {
  /** Who writes it. */
  writers: string;
  /** How it is stored. */
  stored: string;
  /** Metres as a function of the code d, and of near and far in metres, for documents. */
  formula: string;
  /** How the numbers betray it, for documents. */
  signs: string;
  /** Default near and far; `null` if they must be stated, `undefined` for a code without. */
  range?: readonly [near: number, far: number] | null;
  /** Whether it is stored in the channels of an 8-bit PNG. */
  isPacked?: true;
  /** Metres; NaN without a reading. */
  metres(code: number, near: number, far: number): number;
}

const bytesOf24 = 2 ** 24 - 1;

/** Codes whose steps grow with the distance: equal steps of log(z + 3.5 m). Zero is no reading. */
const logarithmic =
  (levels: number) =>
  (code: number, near: number, far: number): number =>
    code > 0 ? (near + SHIFT) * ((far + SHIFT) / (near + SHIFT)) ** (code / levels) - SHIFT : Number.NaN;

/** Metres. */
const SHIFT = 3.5;

export const depthCodes: { readonly [K in DepthCode]: Code } = {
  "sun-rgbd": {
    writers: "SUN RGB-D",
    stored: "16-bit PNG",
    formula: "millimetres, their bits rotated to the left by three",
    signs: "all values are multiples of 8",
    metres: (code) => ((code >> 3) | ((code & 7) << 13)) / 1000,
  },
  lerobot: {
    writers: "LeRobot from 0.6: frames of depth videos",
    stored: "12 bits in 16",
    formula: "(near + 3.5)·((far + 3.5)/(near + 3.5))^(d/4095) − 3.5",
    signs: "the largest value is 4095; mostly none",
    range: [0.01, 10],
    metres: logarithmic(4095),
  },
  behavior: {
    writers: "BEHAVIOR-1K: frames of depth videos",
    stored: "14 bits in 16",
    formula: "(near + 3.5)·((far + 3.5)/(near + 3.5))^(d/16383) − 3.5",
    signs: "the largest value is 16383; mostly none",
    range: [0, 10],
    metres: logarithmic(16383),
  },
  "half-float": {
    writers: "CO3D",
    stored: "16-bit PNG",
    formula: "the bits of a 16-bit float",
    signs: "all values are between 11 264 and 23 552 (0.06 to 256)",
    metres: halfFloat,
  },
  rlbench: {
    writers: "RLBench, PerAct, COLOSSEUM",
    stored: "8-bit PNG in colours",
    formula: "near + (far − near)·(65536·red + 256·green + blue)/16777215",
    signs: "red is smooth, blue is like noise",
    range: null,
    isPacked: true,
    metres(code, near, far) {
      const [red, green, blue] = [code & 255, (code >> 8) & 255, code >> 16];
      return near + ((far - near) * (65536 * red + 256 * green + blue)) / bytesOf24;
    },
  },
  carla: {
    writers: "CARLA, SHIFT",
    stored: "8-bit PNG in colours",
    formula: "far·(red + 256·green + 65536·blue)/16777215; nothing is hit at far",
    signs: "blue is smooth, red is like noise",
    range: [0, 1000],
    isPacked: true,
    metres: (code, _, far) => (code < bytesOf24 ? (far * code) / bytesOf24 : Number.NaN),
  },
  "rgba-float": {
    writers: "TartanAir V2",
    stored: "8-bit PNG with alpha",
    formula: "the 32-bit float with the bytes blue, green, red, alpha",
    signs: "alpha has a few values around 64",
    isPacked: true,
    metres: (code) => code,
  },
  "z-buffer": {
    writers: "OpenGL, MuJoCo, robosuite, LIBERO, PyBullet",
    stored: "floats from 0 to 1, or 16-bit integers of this range",
    formula: "near·far/(far − d·(far − near)); nothing is hit at 1",
    signs: "floats of at most 1, most of them near 1",
    range: null,
    metres: (code, near, far) => (code < 1 ? (near * far) / (far - code * (far - near)) : Number.NaN),
  },
};

/** The value of a 16-bit float with these bits. */
function halfFloat(bits: number): number {
  const [exponent, fraction] = [(bits >> 10) & 31, (bits & 1023) / 1024];
  if (exponent === 31) return Number.NaN;
  const value = exponent === 0 ? fraction * 2 ** -14 : (1 + fraction) * 2 ** (exponent - 15);
  return bits >> 15 === 0 ? value : Number.NaN;
}

/** Settings of a code. */
export interface CodeRange {
  depthNear?: number | undefined;
  depthFar?: number | undefined;
}

/** Metres, 0 without a reading, of codes. */
export function decodedDepth(
  codes: ArrayLike<number>,
  name: DepthCode,
  { depthNear, depthFar }: CodeRange,
): Float32Array {
  const { range, metres } = depthCodes[name];
  const [near, far] = [depthNear ?? range?.[0] ?? Number.NaN, depthFar ?? range?.[1] ?? Number.NaN];
  if (range !== undefined) {
    finite("depthNear", range === null ? depthNear : near);
    finite("depthFar", range === null ? depthFar : far);
    if (!(near >= 0 && far > near)) {
      const remedy =
        "Pass the distances in metres that the code was made with: those of the near and far planes of the camera.";
      throw invalidArgument("depthFar", far, "0 ≤ depthNear < depthFar", remedy);
    }
  }
  // Integers of a z-buffer span its range.
  const whole = name === "z-buffer" && codes instanceof Uint16Array ? 65535 : 1;
  return Float32Array.from(codes, (code) => {
    const depth = metres(code / whole, near, far);
    return Number.isFinite(depth) && depth > 0 && (code !== 0 || depthCodes[name].isPacked) ? depth : 0;
  });
}
