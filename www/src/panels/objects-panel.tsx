/** The outliner: the objects of the scene, each to be selected, shown, locked, renamed and removed. */
import { useState } from "preact/hooks";
import type { ObjectModel, Run } from "../state/object-model.js";
import { percent, type Unit } from "../ui/format.js";
import { Icon } from "../ui/icons.js";
import { useWorkspace } from "../ui/workspace.js";

function stateOf(run: Run, object: ObjectModel, unit: Unit): string {
  if (run.state === "waiting") return "waiting";
  if (run.state === "running") return `${Math.round(100 * run.fraction)} %`;
  if (run.state === "failed") return "failed";
  if (!object.isPlaced) return run.state === "cancelled" ? "cancelled" : "not aligned";
  const { sizeM } = object.box.value;
  if (unit !== null) return sizeM.map((side) => (side / unit).toFixed(2)).join("×");
  return `${sizeM.map((side) => Math.round(100 * side)).join("×")} cm`;
}

export function ObjectsPanel() {
  const { fileActions, inputs, isReading, scene } = useWorkspace();
  const files = fileActions.value;
  const objects = scene.value?.objects ?? [];
  // While a scene is being read, its objects are listed already, so that the layout does not shift.
  const awaited = isReading.value ? inputs.value.objects.slice(objects.length) : [];
  if (objects.length + awaited.length < 2) return null;
  return (
    <section class="panel objects-panel" part="objects" aria-labelledby="objects-title">
      <div class="card-head">
        <h2 id="objects-title">Objects</h2>
        {files !== null && (
          <button type="button" onClick={files.edit}>
            Add or pair …
          </button>
        )}
      </div>
      <ul class="objects">
        {objects.map((object) => (
          <Row key={object.id} object={object} />
        ))}
        {awaited.map(({ name }) => (
          <li key={name}>
            <button type="button" class="select" disabled>
              <span class="name">{name}</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

function Row({ object }: { object: ObjectModel }) {
  const { isReadonly, isRunning, removeObject } = useWorkspace();
  const { name, isShown, isLocked } = object;
  const [isRenamed, setRenamed] = useState(false);
  return (
    <li data-shown={isShown.value} data-plain={isShown.value && !isLocked.value}>
      {isRenamed && !isReadonly.value ? (
        <input
          class="rename"
          aria-label={`New name of ${name}`}
          value={name}
          ref={(field) => field?.select()}
          onKeyDown={({ key, currentTarget }) => (key === "Enter" || key === "Escape") && currentTarget.blur()}
          onBlur={({ currentTarget }) => {
            object.title.value = currentTarget.value.trim() || name;
            setRenamed(false);
          }}
        />
      ) : (
        <ObjectButton object={object} onRename={() => setRenamed(true)} />
      )}
      <Toggle
        label={`Show ${name}`}
        isOn={isShown.value}
        icon={isShown.value ? "shown" : "hidden"}
        onToggle={() => toggle(isShown)}
      />
      {!isReadonly.value && (
        <>
          <Toggle
            label={`Lock ${name}`}
            isOn={isLocked.value}
            icon={isLocked.value ? "locked" : "unlocked"}
            onToggle={() => toggle(isLocked)}
          />
          <button
            type="button"
            class="icon"
            aria-label={`Remove ${name}`}
            disabled={isRunning.value}
            onClick={() => removeObject(object)}
          >
            ×
          </button>
        </>
      )}
    </li>
  );
}

const toggle = (state: { value: boolean }) => {
  state.value = !state.value;
};

interface ToggleProps {
  label: string;
  isOn: boolean;
  icon: Parameters<typeof Icon>[0]["name"];
  onToggle(): void;
}

function Toggle({ label, isOn, icon, onToggle }: ToggleProps) {
  return (
    <button type="button" class="icon" aria-label={label} aria-pressed={isOn} title={label} onClick={onToggle}>
      <Icon name={icon} />
    </button>
  );
}

function ObjectButton({ object, onRename }: { object: ObjectModel; onRename(): void }) {
  const { select, selected, unit } = useWorkspace();
  const { id, name, colour, run, isAccepted } = object;
  const { confidence } = object;
  return (
    <button
      type="button"
      class="select"
      aria-pressed={selected.value === object}
      title="Double-click to rename"
      onClick={() => select(id)}
      onDblClick={onRename}
      onKeyDown={({ key }) => key === "F2" && onRename()}
    >
      <span class="swatch" style={{ background: colour }} />
      <span class="name">{name}</span>
      <span class="state">{stateOf(run.value, object, unit.value)}</span>
      <span class="confidence">{isAccepted.value ? "✓" : confidence === null ? "" : percent(confidence)}</span>
    </button>
  );
}
