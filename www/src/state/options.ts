/** Options of an alignment that the page offers. */
import { signal } from "@preact/signals";
import type { AlignOptions, PaperOptions, Quality } from "sim3align";
import type { ElementOptions } from "../element/sim3-align.js";
import type { ObjectModel } from "./object-model.js";

/** The options of `align` that the page sets. */
export type CallOptions = Omit<AlignOptions, "metrics" | "onProgress" | "signal">;

/** The state of the form. `null` is an empty field. */
export type Options = ElementOptions;

/** Facts of the package's option table, inserted by the build: importing all of it would add 2 kB to the script. */
declare const OPTION_TABLE: {
  readonly quality: readonly Quality[];
  readonly maxSeed: number;
  readonly defaults: Pick<Options, "quality" | "symmetry" | "seed">;
};

export const defaultOptions: Options = {
  preset: "precise",
  quality: OPTION_TABLE.defaults.quality,
  scaleMin: null,
  scaleMax: null,
  up: "unknown",
  symmetry: OPTION_TABLE.defaults.symmetry,
  seed: OPTION_TABLE.defaults.seed,
};

/** The options that are chosen from a list. */
type ChoiceName = "preset" | "quality" | "up" | "symmetry";

/** The values of these options. */
export const choices: { readonly [K in ChoiceName]: readonly Options[K][] } = {
  preset: ["precise", "paper"],
  quality: OPTION_TABLE.quality,
  up: ["unknown", "y", "z"],
  symmetry: ["auto", "none"],
};

/** The largest seed. */
export const MAX_SEED = OPTION_TABLE.maxSeed;

/** The options of the alignments of a scene. */
export function optionsState() {
  const options = signal<Options>(defaultOptions);

  function setOption<K extends keyof Options>(name: K, value: Options[K]): void {
    options.value = { ...options.peek(), [name]: value };
  }

  /** The options of the baseline. */
  function paperOptions(): Omit<PaperOptions, "metrics"> {
    return { preset: "paper", seed: options.peek().seed };
  }

  /** The options of every object of a scene. */
  function sceneOptions(): CallOptions {
    const { quality, seed } = options.peek();
    return { quality, seed };
  }

  /** What is known of an object: every alignment, from scratch or from its pose, obeys it. */
  function constraintsOf(object: ObjectModel): CallOptions {
    const { scaleMin, scaleMax, up, symmetry } = options.peek();
    const { initial } = object;
    const known = object.knownScale.peek();
    const hasBounds = scaleMin !== null || scaleMax !== null;
    return {
      symmetry,
      // A scale that is known goes before a first pose.
      ...(known !== null
        ? { scale: known }
        : hasBounds
          ? { scale: [scaleMin ?? 1e-9, scaleMax ?? 1e9] }
          : initial && { initial }),
      ...(up === "unknown" ? {} : { cameraUp: [0, -1, 0], meshUp: up === "y" ? [0, 1, 0] : [0, 0, 1] }),
    };
  }

  /** The options of an alignment of one object: from scratch, or around its pose only. */
  function alignOptions(object: ObjectModel, search: "global" | "local"): CallOptions {
    const local = search === "local" ? { search, initial: object.pose.peek().transform } : {};
    return { ...sceneOptions(), ...constraintsOf(object), ...local };
  }

  return { options, setOption, paperOptions, sceneOptions, constraintsOf, alignOptions };
}
