/** Options of an alignment that the page offers. */
import { signal } from "@preact/signals";
import {
  ALIGN_DEFAULTS,
  type AlignOptions,
  type ExtentAxis,
  PAPER_DEFAULTS,
  type PaperOptions,
  type Preset,
  type Quality,
  type Sim3,
} from "sim3align";

/** The options of `align` that the page sets. */
export type CallOptions = Omit<AlignOptions, "metrics"> | Omit<PaperOptions, "metrics">;

/** The state of the form. `null` is an empty field. */
export interface Options {
  preset: Preset;
  quality: Quality;
  /** The object's known length in centimetres. */
  knownExtentCm: number | null;
  knownExtentAxis: ExtentAxis;
  /** Bounds of the scale, metres per mesh unit. */
  scaleMin: number | null;
  scaleMax: number | null;
  /** The mesh axis that points up, for a level camera and an object that stands upright. */
  up: "unknown" | "y" | "z";
  symmetry: "auto" | "auto-revolution" | "none";
  /** Whether refining and the handles leave the scale unchanged. */
  lockScale: boolean;
  seed: number;
}

export const defaultOptions: Options = {
  preset: ALIGN_DEFAULTS.preset,
  quality: ALIGN_DEFAULTS.quality,
  knownExtentCm: ALIGN_DEFAULTS.knownExtentM,
  knownExtentAxis: ALIGN_DEFAULTS.knownExtentAxis,
  scaleMin: null,
  scaleMax: null,
  up: "unknown",
  symmetry: ALIGN_DEFAULTS.symmetry,
  lockScale: false,
  seed: ALIGN_DEFAULTS.seed,
};

/** Facts of the package's option table, inserted by the build: importing all of it would add 2 kB to the script. */
declare const OPTION_TABLE: {
  readonly quality: readonly Quality[];
  readonly knownExtentAxis: readonly ExtentAxis[];
  readonly maxSeed: number;
};

/** The options that are chosen from a list. */
type ChoiceName = "preset" | "quality" | "knownExtentAxis" | "up" | "symmetry";

/** The values of these options. */
export const choices: { readonly [K in ChoiceName]: readonly Options[K][] } = {
  preset: [ALIGN_DEFAULTS.preset, PAPER_DEFAULTS.preset],
  quality: OPTION_TABLE.quality,
  knownExtentAxis: OPTION_TABLE.knownExtentAxis,
  up: ["unknown", "y", "z"],
  symmetry: ["auto", "auto-revolution", "none"],
};

/** The largest seed. */
export const MAX_SEED = OPTION_TABLE.maxSeed;

export const options = signal<Options>(defaultOptions);

export function setOption<K extends keyof Options>(name: K, value: Options[K]): void {
  options.value = { ...options.peek(), [name]: value };
}

/** The options of `align` for an alignment from scratch. */
export function alignOptions(chosen = options.peek()): CallOptions {
  const { preset, seed } = chosen;
  if (preset === "paper") return { preset, seed };
  const { scaleMin, scaleMax, knownExtentCm, up } = chosen;
  const hasBounds = scaleMin !== null || scaleMax !== null;
  return {
    seed,
    quality: chosen.quality,
    symmetry: chosen.symmetry,
    ...(knownExtentCm === null ? {} : { knownExtentM: knownExtentCm / 100, knownExtentAxis: chosen.knownExtentAxis }),
    ...(hasBounds ? { scale: [scaleMin ?? 1e-9, scaleMax ?? 1e9] } : {}),
    ...(up === "unknown" ? {} : { cameraUp: [0, -1, 0], meshUp: up === "y" ? [0, 1, 0] : [0, 0, 1] }),
  };
}

/** The options of `align` for a search around a pose only. */
export function refineOptions(initial: Sim3): CallOptions {
  const { quality, seed, symmetry, lockScale } = options.peek();
  return { quality, seed, symmetry, search: "local", initial, ...(lockScale ? { scale: initial.scale } : {}) };
}
