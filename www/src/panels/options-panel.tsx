/** What is known of the object, and how the search goes about it. */
import { defaultOptions, type Options, options, setOption } from "../state/options.js";
import { Choices } from "../ui/choices.js";
import { Tip } from "../ui/tip.js";

interface Choice<K extends keyof Options> {
  name: K;
  title: string;
  about: string;
  choices: readonly [value: Options[K] & string, title: string][];
}

const axisChoice: Choice<"knownExtentAxis"> = {
  name: "knownExtentAxis",
  title: "Measured along",
  about: "Which side of the mesh's box the known length is that of, in the mesh's own axes.",
  choices: [
    ["longest", "longest side"],
    ["x", "x (width)"],
    ["y", "y (height)"],
    ["z", "z (depth)"],
  ],
};

const upChoice: Choice<"up"> = {
  name: "up",
  title: "Stands upright",
  about:
    "Where the camera was held level and the object stands, poses in which it stands upright are favoured. Say which of the mesh's axes points up: y in glTF, z in many others.",
  choices: [
    ["unknown", "not known"],
    ["y", "mesh y is up"],
    ["z", "mesh z is up"],
  ],
};

const symmetryChoice: Choice<"symmetry"> = {
  name: "symmetry",
  title: "Symmetry",
  about: "Turns under which the object looks the same are not listed as alternatives.",
  choices: [
    ["auto", "half turns, as found"],
    ["auto-revolution", "any turn, as found"],
    ["none", "none"],
  ],
};

function Select<K extends "knownExtentAxis" | "up" | "symmetry">({ name, title, about, choices }: Choice<K>) {
  const id = `option-${name}`;
  return (
    <div class="option">
      <label for={id}>{title}</label>
      <Tip label={title.toLowerCase()}>{about}</Tip>
      <Choices id={id} value={options.value[name]} choices={choices} onChoose={(value) => setOption(name, value)} />
    </div>
  );
}

interface NumberProps {
  name: "knownExtentCm" | "scaleMin" | "scaleMax" | "seed";
  title: string;
  about: string;
  unit?: string;
}

function NumberField({ name, title, about, unit = "" }: NumberProps) {
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
          step={name === "seed" ? 1 : "any"}
          inputMode="decimal"
          placeholder="not known"
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
  const isPaper = options.value.preset === "paper";
  return (
    <details class="panel options-panel" id="options">
      <summary>
        <h2>What is known</h2>
      </summary>
      {isPaper && <p class="quiet">The baseline takes none of these, the seed excepted.</p>}
      <NumberField
        name="knownExtentCm"
        title="Real length"
        about="How long the object is in reality, which fixes the scale."
        unit="cm"
      />
      <Select {...axisChoice} />
      <NumberField
        name="scaleMin"
        title="Scale, at least"
        about="Metres per mesh unit, at least. 1 in both fields: the mesh is in metres."
        unit="m"
      />
      <NumberField name="scaleMax" title="Scale, at most" about="Metres per mesh unit, at most." unit="m" />
      <Select {...upChoice} />
      <Select {...symmetryChoice} />
      <NumberField
        name="seed"
        title="Seed"
        about="The same input, options and seed give the same bits, on every machine."
      />
      <button
        type="button"
        onClick={() => {
          options.value = defaultOptions;
        }}
      >
        Back to the defaults
      </button>
    </details>
  );
}
