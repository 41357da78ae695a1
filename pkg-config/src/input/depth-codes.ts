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
    signs: "planes are flat if the numbers are its codes, and not if they are millimetres",
    range: [0.01, 10],
    metres: logarithmic(4095),
  },
  behavior: {
    writers: "BEHAVIOR-1K: frames of depth videos",
    stored: "14 bits in 16",
    formula: "(near + 3.5)·((far + 3.5)/(near + 3.5))^(d/16383) − 3.5",
    signs: "planes are flat if the numbers are its codes, and not if they are millimetres",
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

/** How planes are found: in how many blocks along each side, from how many lines of one, and up to which misfit relative to its range. */
interface PlaneSearch {
  blocks: number;
  lines: number;
  misfit: number;
}

/** A plane at depth z has 1/z = a + b·u + c·v, so that planes tell codes from depth: of a z-buffer, the numbers are linear. */
const ofBuffers: PlaneSearch = { blocks: 6, lines: 32, misfit: 0.02 };

/** Logarithmic codes differ little from depth times a factor, so that larger blocks are needed. */
const ofLogarithms: PlaneSearch = { blocks: 4, lines: 64, misfit: 0.06 };

/** How much better planes are in a z-buffer, as a logarithm. */
const BETTER = 0.02;

/**
 * The bend of planes that are read as logarithmic codes, as a share of that of lengths: 0 of codes, 1 of lengths, up to here either
 * way; and how many standard deviations it must be from 1. Of 430 maps in millimetres, half of them with planes, none is.
 */
const UNBENT = { share: 0.3, deviations: 2.5 } as const;

/** The least number of planes. */
const PLANES = 3;

/** Least mean and largest range of values that are those of a z-buffer unless planes say otherwise: of near planes far before the scene. */
const AT_END = { mean: 0.9, range: 0.1 } as const;

/** Whether numbers that may be a code are one, by the planes that the map shows; `undefined` if these do not tell. */
export function isCoded(
  name: DepthCode,
  numbers: ArrayLike<number>,
  { width = 0, height = 0 }: { width?: number | undefined; height?: number | undefined },
  { mean, most, least }: Record<"mean" | "most" | "least", number>,
): boolean | undefined {
  if (name === "z-buffer") {
    const ratios = blocksOf(numbers, width, height, ofBuffers).flatMap((points) => {
      const [a, b] = [planeOf(points).misfit, planeOf(withValues(points, (code) => 1 / code)).misfit];
      return Math.min(a, b) < ofBuffers.misfit ? [Math.log(b / a)] : [];
    });
    const [buffers = 0, depths = 0] = [1, -1].map((sign) => ratios.filter((ratio) => sign * ratio > BETTER).length);
    if (depths > buffers) return false;
    const isAtEnd = mean >= AT_END.mean && most - least < AT_END.range;
    return depths === 0 && (buffers >= PLANES || isAtEnd) ? true : undefined;
  }
  const { range, metres } = depthCodes[name];
  if (range === undefined) return true;
  const [near, far] = range ?? [0, 1];
  return areUnbent(blocksOf(numbers, width, height, ofLogarithms), (code) => 1 / metres(code, near, far));
}

/** Whether the planes among blocks are flat in a function of their values, and not in 1/value. */
function areUnbent(blocks: readonly Point[][], inverse: (code: number) => number): boolean {
  const bends: [share: number, weight: number][] = [];
  for (const points of blocks) {
    const found = planeOf(withValues(points, inverse));
    if (!(found.misfit < ofLogarithms.misfit)) continue;
    const lengths = planeOf(withValues(points, (code) => 1 / code));
    // What a plane of lengths would be.
    const bent = planeOf(points.map(([u, v], i) => [u, v, inverse(1 / (lengths.values[i] as number))]));
    const [square, product] = [bent.rest, found.rest].map((rest) =>
      rest.reduce((sum, x, i) => sum + x * (bent.rest[i] as number), 0),
    ) as [number, number];
    bends.push([product / square, square / found.variance]);
  }
  const weight = bends.reduce((sum, [, w]) => sum + w, 0);
  const mean = bends.reduce((sum, [share, w]) => sum + w * share, 0) / weight;
  const scatter = bends.reduce((sum, [share, w]) => sum + (w * (share - mean)) ** 2, 0);
  const deviation = Math.sqrt(Math.max(scatter, weight)) / weight;
  return bends.length >= PLANES && Math.abs(mean) < UNBENT.share && 1 - mean > UNBENT.deviations * deviation;
}

/** A pixel and its value. */
type Point = readonly [u: number, v: number, value: number];

const withValues = (points: readonly Point[], of: (value: number) => number): Point[] =>
  points.map(([u, v, value]) => [u, v, of(value)]);

/** Points of the blocks of an image that have a reading everywhere; blocks overlap by half. */
function blocksOf(
  numbers: ArrayLike<number>,
  width: number,
  height: number,
  { blocks, lines }: PlaneSearch,
): Point[][] {
  const [columns, rows] = [Math.floor(width / blocks), Math.floor(height / blocks)];
  const [stepU, stepV] = [Math.ceil(columns / lines), Math.ceil(rows / lines)];
  const found: Point[][] = [];
  for (let top = 0; top + rows <= height && rows > 4; top += rows >> 1) {
    for (let left = 0; left + columns <= width && columns > 4; left += columns >> 1) {
      const points: Point[] = [];
      for (let v = top; v < top + rows; v += stepV)
        for (let u = left; u < left + columns; u += stepU) points.push([u, v, numbers[v * width + u] as number]);
      if (points.every(([, , code]) => code > 0)) found.push(points);
    }
  }
  return found;
}

/** A plane through values on a grid. */
interface Plane {
  values: number[];
  /** What the values have beyond it, and their mean square. */
  rest: number[];
  variance: number;
  /** The root mean square distance, relative to the range of the plane. */
  misfit: number;
}

function planeOf(points: readonly Point[]): Plane {
  const mean = (axis: 0 | 1 | 2) => points.reduce((sum, point) => sum + point[axis], 0) / points.length;
  const [u0, v0, value0] = [mean(0), mean(1), mean(2)];
  let [uu, vv, uz, vz] = [0, 0, 0, 0];
  for (const [u, v, value] of points) {
    uu += (u - u0) ** 2;
    vv += (v - v0) ** 2;
    uz += (u - u0) * (value - value0);
    vz += (v - v0) * (value - value0);
  }
  const [a, b] = [uz / uu, vz / vv];
  const values = points.map(([u, v]) => value0 + a * (u - u0) + b * (v - v0));
  const rest = points.map(([, , value], i) => value - (values[i] as number));
  const variance = rest.reduce((sum, x) => sum + x * x, 0) / points.length;
  const [least, most] = values.reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [
    Number.POSITIVE_INFINITY,
    Number.NEGATIVE_INFINITY,
  ] as [number, number]);
  return { values, rest, variance, misfit: Math.sqrt(variance) / (most - least) };
}
