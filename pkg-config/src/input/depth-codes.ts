/**
 * Codes in which programs store depth: numbers that are no multiples of a length. Loaded only where a code is stated, or where
 * the numbers look like one; what decides that is in `coded-depth.ts`.
 */
import type { DepthCode, DepthCoding } from "../types/inputs.js";
import { invalidArgument } from "../values/error.js";
import { type PixelArray, pixelsOf } from "../values/pixels.js";
import { finite, oneOf, optionsOf } from "../values/validation.js";
import { depthCodeNames } from "./formats.js";

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

/** What to pass for a code, for people. */
export const passingCode = (name: DepthCode): string =>
  `pass depthCode "${name}"${depthCodes[name].range === null ? " with depthNear and depthFar, the near and far planes of the camera in metres" : ""}.`;

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

/**
 * A test whether numbers that may be a code are one, by the planes that the map shows; it returns `undefined` if these do not
 * tell.
 */
export function codeTest(
  numberAt: (pixel: number) => number,
  { width = 0, height = 0 }: { width?: number | undefined; height?: number | undefined },
  { mean, most, least }: Record<"mean" | "most" | "least", number>,
): (name: DepthCode) => boolean | undefined {
  let planes: readonly FlatBlock[] | undefined;
  return (name) => {
    const { range, metres } = depthCodes[name];
    if (range === undefined) return true;
    if (name !== "z-buffer") {
      planes ??= flatBlocks(blocksOf(numberAt, width, height, ofLogarithms));
      const [near, far] = range ?? [0, 1];
      // Whole numbers of few values.
      const inverses = Float64Array.from({ length: most + 1 }, (_, code) => 1 / metres(code, near, far));
      return areUnbent(planes, (code) => inverses[code] ?? 1 / metres(code, near, far));
    }
    const ratios = blocksOf(numberAt, width, height, ofBuffers).flatMap((block) => {
      const [a, b] = [planeOf(block).misfit, planeOf(mapped(block, (code) => 1 / code)).misfit];
      return Math.min(a, b) < ofBuffers.misfit ? [Math.log(b / a)] : [];
    });
    const [buffers = 0, depths = 0] = [1, -1].map((sign) => ratios.filter((ratio) => sign * ratio > BETTER).length);
    if (depths > buffers) return false;
    const isAtEnd = mean >= AT_END.mean && most - least < AT_END.range;
    return depths === 0 && (buffers >= PLANES || isAtEnd) ? true : undefined;
  };
}

/** A block, and the plane through it if its values are lengths. */
interface FlatBlock {
  block: Block;
  lengths: Plane;
}

/** The blocks that are about flat if their values are lengths: others are not flat in a code either. */
const flatBlocks = (blocks: readonly Block[]): FlatBlock[] =>
  blocks.flatMap((block) => {
    const lengths = planeOf(mapped(block, (code) => 1 / code));
    return lengths.misfit < 3 * ofLogarithms.misfit ? [{ block, lengths }] : [];
  });

/** Whether the planes among blocks are flat in a function of their values, and not in 1/value. */
function areUnbent(blocks: readonly FlatBlock[], inverse: (code: number) => number): boolean {
  const bends: [share: number, weight: number][] = [];
  for (const { block, lengths } of blocks) {
    const found = planeOf(mapped(block, inverse));
    if (!(found.misfit < ofLogarithms.misfit)) continue;
    // What a plane of lengths would be.
    const bent = planeOf(mapped({ ...block, values: lengths.values }, (value) => inverse(1 / value)));
    let [square, product] = [0, 0];
    for (let i = 0; i < bent.rest.length; i++) {
      const x = bent.rest[i] as number;
      square += x * x;
      product += x * (found.rest[i] as number);
    }
    bends.push([product / square, square / found.variance]);
  }
  const weight = bends.reduce((sum, [, w]) => sum + w, 0);
  const mean = bends.reduce((sum, [share, w]) => sum + w * share, 0) / weight;
  const scatter = bends.reduce((sum, [share, w]) => sum + (w * (share - mean)) ** 2, 0);
  const deviation = Math.sqrt(Math.max(scatter, weight)) / weight;
  return bends.length >= PLANES && Math.abs(mean) < UNBENT.share && 1 - mean > UNBENT.deviations * deviation;
}

/** Values on a grid, row by row. */
interface Block {
  values: Float64Array;
  columns: number;
}

const mapped = ({ values, columns }: Block, of: (value: number) => number): Block => ({
  values: values.map(of),
  columns,
});

/** The blocks of an image that have a reading everywhere; they overlap by half. */
function blocksOf(
  numberAt: (pixel: number) => number,
  width: number,
  height: number,
  { blocks, lines }: PlaneSearch,
): Block[] {
  const [columns, rows] = [Math.floor(width / blocks), Math.floor(height / blocks)];
  const [stepU, stepV] = [Math.ceil(columns / lines), Math.ceil(rows / lines)];
  const [across, down] = [Math.ceil(columns / stepU), Math.ceil(rows / stepV)];
  const found: Block[] = [];
  for (let top = 0; top + rows <= height && rows > 4; top += rows >> 1) {
    for (let left = 0; left + columns <= width && columns > 4; left += columns >> 1) {
      const values = new Float64Array(across * down);
      let isWhole = true;
      for (let i = 0; i < values.length && isWhole; i++) {
        const [u, v] = [left + stepU * (i % across), top + stepV * Math.floor(i / across)];
        values[i] = numberAt(v * width + u);
        isWhole = (values[i] as number) > 0;
      }
      if (isWhole) found.push({ values, columns: across });
    }
  }
  return found;
}

/** A plane through values on a grid. */
interface Plane {
  values: Float64Array;
  /** What the values have beyond it, and their mean square. */
  rest: Float64Array;
  variance: number;
  /** The root mean square distance, relative to the range of the plane. */
  misfit: number;
}

function planeOf({ values, columns }: Block): Plane {
  const rows = values.length / columns;
  const [u0, v0] = [(columns - 1) / 2, (rows - 1) / 2];
  let [sum, uz, vz] = [0, 0, 0];
  for (let i = 0, v = 0; v < rows; v++) {
    for (let u = 0; u < columns; u++, i++) {
      const value = values[i] as number;
      sum += value;
      uz += (u - u0) * value;
      vz += (v - v0) * value;
    }
  }
  // The sums of squares of a grid.
  const [a, b] = [(12 * uz) / (rows * columns * (columns ** 2 - 1)), (12 * vz) / (columns * rows * (rows ** 2 - 1))];
  const mean = sum / values.length;
  const [plane, rest] = [new Float64Array(values.length), new Float64Array(values.length)];
  let squares = 0;
  for (let i = 0, v = 0; v < rows; v++) {
    for (let u = 0; u < columns; u++, i++) {
      const [on, value] = [mean + a * (u - u0) + b * (v - v0), values[i] as number];
      plane[i] = on;
      rest[i] = value - on;
      squares += (value - on) ** 2;
    }
  }
  const variance = squares / values.length;
  const range = Math.abs(a) * (columns - 1) + Math.abs(b) * (rows - 1);
  return { values: plane, rest, variance, misfit: Math.sqrt(variance) / range };
}

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
