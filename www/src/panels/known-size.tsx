/** A known length of an object. It is one fact of the object, wherever it is entered. */
import { useState } from "preact/hooks";
import { canTry, setKnownSize, type Trial, takeTrial, trySize } from "../alignment/known-size.js";
import type { ObjectModel } from "../state/object-model.js";
import { inOrder, sidesOf } from "../state/sides.js";
import { Choices } from "../ui/controls.js";
import { NumberInput } from "../ui/number-input.js";
import { centimetres, orDash, percent } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

const edges = ["Longest edge", "Middle edge", "Shortest edge"] as const;
const choices = edges.map((title, i) => [`${i}`, title] as const);

/** The edges of the smallest box, longest first, as the lines of the 3D view show them. */
const edgesOf = (object: ObjectModel | null) => [...(object?.box.value.sizeM ?? [0, 0, 0])].sort((a, b) => b - a);

interface KnownSizeProps {
  object: ObjectModel | null;
  /** Of the number field. */
  id: string;
}

/** Gives one edge of the object its known length, which all alignments keep. What that changes is shown before it counts. */
export function KnownSize({ object, id }: KnownSizeProps) {
  const workspace = useWorkspace();
  const [edge, setEdge] = useState(0);
  const [trial, setTrial] = useState<Trial | null>(null);
  const lengthsM = edgesOf(object);
  const presentM = lengthsM[edge] ?? 0;
  const isMetric = workspace.unit.value === null;
  // Without a result, there is nothing yet that a length could be compared with.
  const isReady = object !== null && (isMetric || object.isPlaced) && !workspace.isRunning.value;

  const apply = async (wantedCm: number) => {
    const wantedM = wantedCm / 100;
    const isValid = wantedM > 0 && presentM > 0;
    if (object === null || !isValid || (isMetric && centimetres(wantedM) === centimetres(presentM))) return;
    const factor = wantedM / presentM;
    if (canTry(workspace, object)) setTrial(await trySize(workspace, object, factor));
    else setKnownSize(workspace, object, factor);
  };
  return (
    <>
      <fieldset class="row known" disabled={!isReady}>
        <legend>Known size</legend>
        <Choices label="Edge" value={`${edge}`} choices={choices} onChoose={(value) => setEdge(Number(value))} />
        <NumberInput
          id={id}
          min="0"
          aria-label={`${edges[edge]} in centimetres`}
          value={isMetric && presentM > 0 ? centimetres(presentM) : ""}
          onEnter={apply}
        />
        <span class="unit">{isMetric ? "cm" : "centimetres, which makes all sizes metric"}</span>
      </fieldset>
      {object !== null && trial !== null && trial.from === object.pose.value && (
        <Change
          object={object}
          trial={trial}
          onDecide={(isUsed) => {
            if (isUsed) takeTrial(workspace, object, trial);
            else workspace.announce("The old size is kept.");
            setTrial(null);
          }}
        />
      )}
    </>
  );
}

interface ChangeProps {
  object: ObjectModel;
  trial: Trial;
  onDecide(isUsed: boolean): void;
}

/** A fall of the overlap or of the confidence beyond this is said: a little is lost with every constraint. */
const NOTABLE = 0.03;

/** The object as it is beside what it would be. */
function Change({ object, trial, onDecide }: ChangeProps) {
  const iou = object.metrics.value?.iou;
  const { confidence } = object;
  const sides = sidesOf(object, useWorkspace().support.value);
  const size = (sizeM: readonly number[]) =>
    `${inOrder(sides, sizeM)
      .map((m) => centimetres(m))
      .join(" × ")} cm`;
  const rows = [
    ["Size", size(object.box.value.sizeM), size(trial.sizeM)],
    ["Overlap", orDash(iou, percent), orDash(trial.iou, percent)],
    ["Confidence", orDash(confidence, percent), orDash(trial.confidence, percent)],
  ] as const;
  const falls = (before: number | null | undefined, after: number | null) =>
    typeof before === "number" && (after ?? 0) < before - NOTABLE;
  const isWorse = falls(iou, trial.iou) || falls(confidence, trial.confidence);
  return (
    <fieldset class="stack note trial">
      <legend class="visually-hidden">The known size compared</legend>
      <table>
        <thead>
          <tr>
            <td />
            <th scope="col">Old</th>
            <th scope="col">New</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(([title, before, after]) => (
            <tr key={title}>
              <th scope="row">{title}</th>
              <td>{before}</td>
              <td>{after}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p role="status">
        {isWorse
          ? "With this size, the mesh fits worse. Check the edge and the number."
          : "The mesh fits with this size."}
      </p>
      <div class="row">
        <button type="button" class={isWorse ? "" : "primary"} onClick={() => onDecide(true)}>
          Use
        </button>
        <button type="button" class={isWorse ? "primary" : ""} onClick={() => onDecide(false)}>
          Keep the old
        </button>
      </div>
    </fieldset>
  );
}
