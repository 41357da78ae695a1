/** The options that are chosen from a list, each as the list of a form and as commands. */
import { defaultOptions, type Options, choices as values } from "../state/options.js";
import type { Workspace } from "../state/workspace.js";
import { qualityTitles } from "./texts.js";

export interface Choice {
  /** Of the list. */
  id: string;
  title: string;
  about: string;
  titles: readonly (readonly [value: string, title: string])[];
  chosen(options: Options): string;
  choose(workspace: Workspace, value: string): void;
}

/** Presets and qualities as one list. */
export const effort: Choice = {
  id: "effort",
  title: "Quality",
  about: "How much is searched. “Automatic” searches longer where the case is hard.",
  titles: [
    ...values.quality.map((quality) => [quality, qualityTitles[quality]] as const),
    ["paper", "Paper (baseline)"],
  ],
  chosen: ({ preset, quality }) => (preset === "paper" ? "paper" : quality),
  choose({ setOption }, value) {
    const quality = values.quality.find((quality) => quality === value);
    setOption("preset", quality === undefined ? "paper" : "precise");
    setOption("quality", quality ?? defaultOptions.quality);
  },
};

/** The choice of one option. */
const choiceOf = <K extends "up" | "symmetry">(
  name: K,
  texts: Pick<Choice, "title" | "about">,
  titles: { readonly [V in Options[K]]: string },
): Choice => ({
  id: `option-${name}`,
  ...texts,
  titles: (values[name] as readonly Options[K][]).map((value) => [value, titles[value]] as const),
  chosen: (options) => options[name],
  choose({ setOption }, value) {
    setOption(name, value as Options[K]);
  },
});

export const up = choiceOf(
  "up",
  {
    title: "Stands upright",
    about:
      "Prefers upright poses. Use it if the camera was level and the object stands upright. The mesh's up axis is y in glTF, and z in many other files.",
  },
  { unknown: "unknown", y: "mesh y is up", z: "mesh z is up" },
);

export const symmetry = choiceOf(
  "symmetry",
  {
    title: "Symmetry",
    about: "Poses that differ only by a symmetry of the object are not listed as alternatives.",
  },
  { auto: "Find on the mesh", none: "None" },
);

export const choices: readonly Choice[] = [effort, up, symmetry];
