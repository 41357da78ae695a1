/** Options of the alignment: prior knowledge about the object, and the seed. */
import { defaultOptions, MAX_SEED, type Options, choices as values } from "../state/options.js";
import type { Workspace } from "../state/workspace.js";
import { Choices, Tip } from "../ui/controls.js";
import { NumberInput } from "../ui/number-input.js";
import { useWorkspace } from "../ui/workspace.js";

const qualityTitles: { readonly [Q in Options["quality"]]: string } = {
  auto: "Automatic",
  fast: "Fast",
  balanced: "Balanced",
  best: "Best",
};

/** An option that is chosen from a list. */
interface Choice {
  /** Of the list. */
  id: string;
  title: string;
  about: string;
  titles: readonly (readonly [value: string, title: string])[];
  chosen(options: Options): string;
  choose(workspace: Workspace, value: string): void;
}

/** Presets and qualities as one list. */
const effort: Choice = {
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

const up = choiceOf(
  "up",
  {
    title: "Stands upright",
    about:
      "Prefers upright poses. Use it if the camera was level and the object stands upright. The mesh's up axis is y in glTF, and z in many other files.",
  },
  { unknown: "unknown", y: "mesh y is up", z: "mesh z is up" },
);

const symmetry = choiceOf(
  "symmetry",
  {
    title: "Symmetry",
    about: "Poses that differ only by a symmetry of the object are not listed as alternatives.",
  },
  { auto: "Find on the mesh", none: "None" },
);

function Select({ id, title, about, titles, chosen, choose }: Choice) {
  const workspace = useWorkspace();
  return (
    <div class="row option">
      <label for={id}>{title}</label>
      <Tip label={title.toLowerCase()}>{about}</Tip>
      <Choices
        id={id}
        value={chosen(workspace.options.value)}
        choices={titles}
        onChoose={(value) => choose(workspace, value)}
      />
    </div>
  );
}

interface NumberProps {
  name: "scaleMin" | "scaleMax" | "seed";
  title: string;
  about: string;
  unit?: string;
}

function NumberField({ name, title, about, unit = "" }: NumberProps) {
  const { options, setOption } = useWorkspace();
  const id = `option-${name}`;
  return (
    <div class="row option">
      <label for={id}>{title}</label>
      <Tip label={title.toLowerCase()}>{about}</Tip>
      <span class="with-unit">
        <NumberInput
          id={id}
          min="0"
          max={name === "seed" ? MAX_SEED : undefined}
          step={name === "seed" ? "1" : "any"}
          placeholder="none"
          value={options.value[name] ?? ""}
          onEnter={(entered) => setOption(name, (Number.isNaN(entered) ? defaultOptions[name] : entered) as never)}
        />
        <span class="unit">{unit}</span>
      </span>
    </div>
  );
}

export function OptionsPanel() {
  const workspace = useWorkspace();
  const { options, unit } = workspace;
  const metres = unit.value === null ? "m" : "";
  const isPaper = options.value.preset === "paper";
  return (
    <details class="panel options-panel" style={{ gridArea: "options" }} part="options" id="options">
      <summary>
        <h2>Quality and constraints</h2>
      </summary>
      <Select {...effort} />
      {isPaper ? (
        <p class="quiet">The baseline uses only the seed.</p>
      ) : (
        <p class="quiet">For all objects. A known size of one object is set by hand.</p>
      )}
      <NumberField
        name="scaleMin"
        title="Minimum scale"
        about="Lower bound of the scale in metres per mesh unit. For a mesh in metres, enter 1 in both fields."
        unit={metres}
      />
      <NumberField
        name="scaleMax"
        title="Maximum scale"
        about="Upper bound of the scale in metres per mesh unit."
        unit={metres}
      />
      <Select {...up} />
      <Select {...symmetry} />
      <NumberField
        name="seed"
        title="Seed"
        about="Seed of all random draws. The same input, options and seed give bit-identical results on every machine."
      />
      <button
        type="button"
        id="reset-options"
        onClick={() => {
          options.value = defaultOptions;
        }}
      >
        Reset to defaults
      </button>
    </details>
  );
}
