/** Options of the alignment: prior knowledge about the object, and the seed. */
import { defaultOptions, MAX_SEED } from "../state/options.js";
import { type Choice, effort, symmetry, up } from "../ui/choices.js";
import { Choices, Tip } from "../ui/controls.js";
import { useWorkspace } from "../ui/workspace.js";

function Select({ id, title, about, titles, chosen, choose }: Choice) {
  const workspace = useWorkspace();
  return (
    <div class="option">
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
