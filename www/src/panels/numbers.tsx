/** The pose in numbers: the centre, and turns about the axes of the camera. */

import { useState } from "preact/hooks";
import type { Vector3 } from "sim3align/values/validation";
import type { ObjectModel } from "../state/object-model.js";
import { type Nudge, rotationAbout } from "../state/pose.js";
import { Choices } from "../ui/controls.js";
import { NumberInput } from "../ui/number-input.js";
import { useWorkspace } from "../ui/workspace.js";

const axes = ["x", "y", "z"] as const;
const axisChoices = axes.map((axis) => [axis, axis] as const);
const directions = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] } satisfies Record<(typeof axes)[number], Vector3>;

interface NumbersProps {
  object: ObjectModel | null;
  isReady: boolean;
}

export function Numbers({ object, isReady }: NumbersProps) {
  const { nudge, unit } = useWorkspace();
  const [axis, setAxis] = useState<(typeof axes)[number]>("y");
  const centre = object?.box.value.centreM;
  // Metres per unit that is shown.
  const shown = unit.value ?? 0.01;
  const apply = (change: Nudge) => {
    if (object !== null) nudge(object, change);
  };
  const move = (k: number, toM: number) => {
    const from = object?.box.peek().centreM[k] ?? 0;
    if (Number.isFinite(toM) && toM !== from)
      apply({ moveM: [0, 1, 2].map((i) => (i === k ? toM - from : 0)) as Vector3 });
  };
  return (
    <fieldset class="numbers" disabled={!isReady}>
      <legend>Centre in the camera's frame, {unit.value === null ? "cm" : "relative"}</legend>
      {axes.map((name, k) => (
        <label key={name} class="field-inline">
          <span>{name}</span>
          <NumberInput
            id={`centre-${name}`}
            step={unit.value === null ? "0.1" : "0.01"}
            value={centre === undefined ? "" : ((centre[k] ?? 0) / shown).toFixed(2)}
            onEnter={(entered) => move(k, entered * shown)}
          />
        </label>
      ))}
      <span class="field-inline turn">
        <label for="turn-deg">Turn by</label>
        <NumberInput
          id="turn-deg"
          placeholder="90"
          value=""
          onEnter={(degrees) => {
            if (Number.isFinite(degrees)) apply({ rotation: rotationAbout(directions[axis], degrees) });
          }}
        />
        <span>° about</span>
        <Choices label="Axis" value={axis} choices={axisChoices} onChoose={(chosen) => setAxis(chosen)} />
      </span>
    </fieldset>
  );
}
