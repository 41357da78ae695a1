/** The options of an alignment, as far as the page offers them. */
import { signal } from "@preact/signals";
import type { AlignOptions, ExtentAxis, Preset, Quality } from "sim3align";

/** What the form holds; null and "" are "not given". */
export interface Options {
  preset: Preset;
  quality: Quality;
  /** The real length of the object, in centimetres. */
  knownExtentCm: number | null;
  knownExtentAxis: ExtentAxis;
  /** Bounds of the scale, metres per mesh unit. */
  scaleMin: number | null;
  scaleMax: number | null;
  /** Whether the camera is level, and which of the mesh's axes is up: the object then stands upright. */
  up: "unknown" | "y" | "z";
  symmetry: "auto" | "auto-revolution" | "none";
  lockScale: boolean;
  seed: number;
}

export const defaultOptions: Options = {
  preset: "precise",
  quality: "balanced",
  knownExtentCm: null,
  knownExtentAxis: "longest",
  scaleMin: null,
  scaleMax: null,
  up: "unknown",
  symmetry: "auto",
  lockScale: false,
  seed: 0,
};

/** What may stand in a link, where it is a word. */
const words: { readonly [K in keyof Options]?: readonly string[] } = {
  preset: ["precise", "paper"],
  quality: ["fast", "balanced", "best"],
  knownExtentAxis: ["longest", "x", "y", "z"],
  up: ["unknown", "y", "z"],
  symmetry: ["auto", "auto-revolution", "none"],
};

export const options = signal<Options>(defaultOptions);

export function setOption<K extends keyof Options>(name: K, value: Options[K]): void {
  options.value = { ...options.peek(), [name]: value };
}

/** The library's form of the options. */
export function alignOptions(chosen = options.peek()): AlignOptions {
  const { preset, seed } = chosen;
  if (preset === "paper") return { preset, seed };
  const { scaleMin, scaleMax, knownExtentCm, up } = chosen;
  const hasBounds = scaleMin !== null || scaleMax !== null;
  return {
    preset,
    seed,
    quality: chosen.quality,
    symmetry: chosen.symmetry,
    ...(knownExtentCm === null ? {} : { knownExtentM: knownExtentCm / 100, knownExtentAxis: chosen.knownExtentAxis }),
    ...(hasBounds ? { scale: { min: scaleMin ?? 1e-9, max: scaleMax ?? 1e9 } } : {}),
    ...(up === "unknown" ? {} : { cameraUp: [0, -1, 0], meshUp: up === "y" ? [0, 1, 0] : [0, 0, 1] }),
  };
}

/** Those of the options that are not the defaults, as a link holds them. */
export function optionsToLink(chosen: Options): [name: string, value: string][] {
  return Object.entries(chosen)
    .filter(([name, value]) => value !== defaultOptions[name as keyof Options])
    .map(([name, value]) => [name, String(value)]);
}

/** The options that a link holds; what it cannot hold is left at its default. */
export function optionsFromLink(parameters: URLSearchParams): Options {
  const found: Record<string, unknown> = { ...defaultOptions };
  for (const name of Object.keys(defaultOptions) as (keyof Options)[]) {
    const text = parameters.get(name);
    if (text === null) continue;
    const allowed = words[name];
    if (allowed !== undefined) {
      if (allowed.includes(text)) found[name] = text;
    } else if (name === "lockScale") found[name] = text === "true";
    else if (text !== "" && Number(text) >= 0 && Number.isFinite(Number(text))) found[name] = Number(text);
  }
  return found as unknown as Options;
}
