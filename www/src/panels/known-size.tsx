/** A known length of an object. It is one fact of the object, wherever it is entered. */
import { useState } from "preact/hooks";
import { setKnownSize } from "../run/known-size.js";
import type { ObjectModel } from "../state/object-model.js";
import { Choices } from "../ui/controls.js";
import { centimetres } from "../ui/format.js";
import { useWorkspace } from "../ui/workspace.js";

const sides = ["Width", "Height", "Depth", "Longest side"] as const;
const sideChoices = sides.map((title, i) => [`${i}`, title] as const);

interface KnownSizeProps {
  object: ObjectModel | null;
  /** Of the number field. */
  id: string;
  /** Runs after the size was set. */
  onSet?(): void;
}

/** Scales the mesh so that one side has a known length, which all alignments keep. */
export function KnownSize({ object, id, onSet }: KnownSizeProps) {
  const workspace = useWorkspace();
  const [side, setSide] = useState(1);
  const sizeM = object?.box.value.sizeM ?? [0, 0, 0];
  const presentM = sizeM[side] ?? Math.max(...sizeM);
  const isMetric = workspace.unit.value === null;
  // Without a result, there is nothing yet that a length could be compared with.
  const isReady = object !== null && (isMetric || object.isPlaced);

  const apply = (field: HTMLInputElement) => {
    const wantedM = field.valueAsNumber / 100;
    const isValid = wantedM > 0 && presentM > 0;
    if (object === null || !isValid || (isMetric && centimetres(wantedM) === centimetres(presentM))) return;
    setKnownSize(workspace, object, wantedM / presentM);
    onSet?.();
  };
  return (
    <fieldset class="row known" disabled={!isReady}>
      <legend>Known size</legend>
      <Choices label="Side" value={`${side}`} choices={sideChoices} onChoose={(value) => setSide(Number(value))} />
      <input
        id={id}
        type="number"
        min="0"
        step="any"
        inputMode="decimal"
        aria-label={`${sides[side]} in centimetres`}
        value={isMetric && presentM > 0 ? centimetres(presentM) : ""}
        onChange={({ currentTarget }) => apply(currentTarget)}
      />
      <span class="unit">{isMetric ? "cm" : "centimetres, which makes all sizes metric"}</span>
    </fieldset>
  );
}
