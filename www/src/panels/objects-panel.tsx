/** The list of objects. */
import { inputs, isReading } from "../load/open.js";
import type { ObjectModel, Run } from "../state/object-model.js";
import { scene, select, selected } from "../state/scene.js";
import { percent } from "../ui/format.js";

function stateOf(run: Run, object: ObjectModel): string {
  if (run.state === "waiting") return "waiting";
  if (run.state === "running") return `${Math.round(100 * run.fraction)} %`;
  if (run.state === "failed") return "failed";
  if (!object.isPlaced) return run.state === "cancelled" ? "cancelled" : "not aligned";
  return `${object.box.value.sizeM.map((side) => Math.round(100 * side)).join("×")} cm`;
}

export function ObjectsPanel() {
  const objects = scene.value?.objects ?? [];
  // While a scene is being read, its objects are listed already, so that the layout does not shift.
  const awaited = isReading.value ? inputs.value.objects.slice(objects.length) : [];
  if (objects.length + awaited.length < 2) return null;
  return (
    <section class="panel objects-panel" aria-labelledby="objects-title">
      <h2 id="objects-title">Objects</h2>
      <ul class="objects">
        {objects.map((object) => (
          <li key={object.id}>
            <ObjectButton object={object} />
          </li>
        ))}
        {awaited.map(({ name }) => (
          <li key={name}>
            <button type="button" disabled>
              <span class="name">{name}</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

function ObjectButton({ object }: { object: ObjectModel }) {
  const { id, name, colour, run } = object;
  const confidence = object.precise?.confidence ?? null;
  return (
    <button type="button" aria-pressed={selected.value === object} onClick={() => select(id)}>
      <span class="swatch" style={{ background: colour }} />
      <span class="name">{name}</span>
      <span class="state">{stateOf(run.value, object)}</span>
      <span class="confidence">{confidence === null ? "" : percent(confidence)}</span>
    </button>
  );
}
