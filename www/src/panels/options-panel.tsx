/** Options of the alignment: prior knowledge about the object, and the seed. */
import { choices, defaultOptions, MAX_SEED, type Options } from "../state/options.js";
import type { Workspace } from "../state/workspace.js";
import { Choices, Tip } from "../ui/controls.js";
import { qualityTitles } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

/** Presets and qualities as one list. */
const efforts: readonly (readonly [value: string, title: string])[] = [
  ...choices.quality.map((quality) => [quality, qualityTitles[quality]] as const),
  ["paper", "Paper (baseline)"],
];

function chooseEffort({ setOption }: Workspace, value: string): void {
  const quality = choices.quality.find((quality) => quality === value);
  setOption("preset", quality === undefined ? "paper" : "precise");
  setOption("quality", quality ?? defaultOptions.quality);
}

type ChoiceName = "up" | "symmetry";

interface SelectProps<K extends ChoiceName> {
  name: K;
  title: string;
  about: string;
  /** Titles of the values. */
  titles: { readonly [V in Options[K]]: string };
}

const up: SelectProps<"up"> = {
  name: "up",
  title: "Stands upright",
  about:
    "Prefers upright poses. Use it if the camera was level and the object stands upright. The mesh's up axis is y in glTF, and z in many other files.",
  titles: { unknown: "unknown", y: "mesh y is up", z: "mesh z is up" },
};

const symmetry: SelectProps<"symmetry"> = {
  name: "symmetry",
  title: "Symmetry",
  about: "Poses that differ only by a symmetry of the object are not listed as alternatives.",
  titles: { auto: "Find on the mesh", none: "None" },
};

function Select<K extends ChoiceName>({ name, title, about, titles }: SelectProps<K>) {
  const { options, setOption } = useWorkspace();
  const id = `option-${name}`;
  const values: readonly Options[K][] = choices[name];
  return (
    <div class="option">
      <label for={id}>{title}</label>
      <Tip label={title.toLowerCase()}>{about}</Tip>
      <Choices
        id={id}
        value={options.value[name]}
        choices={values.map((value) => [value, titles[value]] as const)}
        onChoose={(value) => setOption(name, value)}
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
    <div class="option">
      <label for={id}>{title}</label>
      <Tip label={title.toLowerCase()}>{about}</Tip>
      <span class="with-unit">
        <input
          id={id}
          type="number"
          min="0"
          max={name === "seed" ? MAX_SEED : undefined}
          step={name === "seed" ? 1 : "any"}
          inputMode="decimal"
          placeholder="unknown"
          value={options.value[name] ?? ""}
          onChange={({ currentTarget: { valueAsNumber } }) =>
            setOption(name, (Number.isNaN(valueAsNumber) ? defaultOptions[name] : valueAsNumber) as never)
          }
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
    <details class="panel options-panel" part="options" id="options">
      <summary>
        <h2>Quality and constraints</h2>
      </summary>
      <div class="option">
        <label for="effort">Quality</label>
        <Tip label="quality">How much is searched. “Automatic” searches longer where the case is hard.</Tip>
        <Choices
          id="effort"
          value={isPaper ? "paper" : options.value.quality}
          choices={efforts}
          onChoose={(value) => chooseEffort(workspace, value)}
        />
      </div>
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
        onClick={() => {
          options.value = defaultOptions;
        }}
      >
        Reset to defaults
      </button>
    </details>
  );
}
