/** A dimension that somebody knows: the mesh gets it, and the scale is locked. */
import { useState } from "preact/hooks";
import { place } from "../state/history.js";
import type { ObjectModel } from "../state/object-model.js";
import { setOption } from "../state/options.js";
import { nudged } from "../state/pose.js";
import { Choices } from "../ui/choices.js";
import { centimetres } from "../ui/format.js";

const sides = ["Width", "Height", "Depth"] as const;
const choices = sides.map((title, i) => [`${i}`, title] as const);

export function KnownSize({ object }: { object: ObjectModel | null }) {
  const [side, setSide] = useState(1);
  const now = object?.box.value.sizeM[side] ?? 0;

  const apply = (field: HTMLInputElement) => {
    const wanted = field.valueAsNumber / 100;
    if (object === null || !(wanted > 0) || !(now > 0) || centimetres(wanted) === centimetres(now)) return;
    const transform = nudged(object.box.peek().centerM, object.pose.peek().transform, { scale: wanted / now });
    place(object, { transform, source: "hand" });
    setOption("lockScale", true);
  };
  return (
    <fieldset class="row known" disabled={object === null}>
      <legend>Known size</legend>
      <Choices label="Side" value={`${side}`} choices={choices} onChoose={(value) => setSide(Number(value))} />
      <input
        id="known-size"
        type="number"
        min="0"
        step="any"
        inputMode="decimal"
        aria-label={`${sides[side]} in centimetres`}
        value={now > 0 ? centimetres(now) : ""}
        onChange={({ currentTarget }) => apply(currentTarget)}
      />
      <span class="unit">cm</span>
    </fieldset>
  );
}
