/** The outliner: the objects of the scene. The selected one has a menu, by which it is shown, locked, renamed and removed. */
import type { ComponentChildren } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Support } from "sim3align";
import { alignSelected } from "../alignment/align.js";
import type { ObjectModel, Run } from "../state/object-model.js";
import { inOrder, sidesOf } from "../state/sides.js";
import { Check, Icon, Menu } from "../ui/controls.js";
import { percent, type Unit } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

function stateOf(run: Run, object: ObjectModel, unit: Unit, ground: Support | null): string {
  if (run.state === "waiting") return "waiting";
  if (run.state === "running") return `${Math.round(100 * run.fraction)} %`;
  if (run.state === "failed") return "failed";
  if (!object.isPlaced) return run.state === "cancelled" ? "cancelled" : "not aligned";
  const sizeM = inOrder(sidesOf(object, ground), object.box.value.sizeM);
  if (unit !== null) return sizeM.map((side) => (side / unit).toFixed(2)).join("×");
  return sizeM.map((side) => Math.round(100 * side)).join("×");
}

/** @param children further controls beside the title */
export function ObjectsPanel({ children }: { children?: ComponentChildren }) {
  const { inputs, isReading, scene, unit } = useWorkspace();
  const objects = scene.value?.objects ?? [];
  // While a scene is being read, its objects are listed already, so that the layout does not shift.
  const awaited = isReading.value ? inputs.value.objects.slice(objects.length) : [];
  if (objects.length + awaited.length < 2) return null;
  return (
    <section class="panel objects-panel" style={{ gridArea: "objects" }} part="objects" aria-labelledby="objects-title">
      <div class="row panel-head">
        <h2 id="objects-title">
          Objects <span class="quiet">{unit.value === null && "cm"}</span>
        </h2>
        <span class="quiet" title="Decided">
          {objects.filter(({ verdict }) => verdict.value !== null).length} of {objects.length + awaited.length}
        </span>
        {children}
      </div>
      <ul class="stack objects">
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
  const { isReadonly, renamed, selected } = useWorkspace();
  const row = useRef<HTMLLIElement>(null);
  const isSelected = selected.value === object;
  // In a long list, the selected object is in sight. The page itself does not scroll.
  useEffect(() => {
    const list = row.current?.parentElement;
    if (!isSelected || row.current === null || list == null) return;
    const { offsetTop: top, offsetHeight: height } = row.current;
    list.scrollTop = Math.min(top, Math.max(list.scrollTop, top + height - list.clientHeight));
  }, [isSelected]);
  return (
    <li data-shown={object.isShown.value} ref={row}>
      {renamed.value === object && !isReadonly.value ? <NameField object={object} /> : <ObjectButton object={object} />}
      {isSelected && <ObjectMenu object={object} />}
    </li>
  );
}

function ObjectMenu({ object }: { object: ObjectModel }) {
  const workspace = useWorkspace();
  const { isReadonly, isRunning, removeObject, renamed } = workspace;
  const { name, isShown, isLocked } = object;
  return (
    <Menu title="⋯" isIcon label={`More for ${name}`}>
      <Check
        title={`Show ${name}`}
        checked={isShown.value}
        onCheck={(checked) => {
          isShown.value = checked;
        }}
      />
      {!isReadonly.value && (
        <>
          <Check
            title="Lock its pose"
            checked={isLocked.value}
            onCheck={(checked) => {
              isLocked.value = checked;
            }}
          />
          <button
            type="button"
            disabled={isRunning.value || isLocked.value}
            aria-keyshortcuts="A"
            onClick={() => alignSelected(workspace)}
          >
            Align this object
          </button>
          <button
            type="button"
            onClick={() => {
              renamed.value = object;
            }}
          >
            Rename
          </button>
          <button type="button" disabled={isRunning.value} onClick={() => removeObject(object)}>
            Remove
          </button>
        </>
      )}
    </Menu>
  );
}

const marks = { accepted: "✓", skipped: "skipped", impossible: "✗" };

function ObjectButton({ object }: { object: ObjectModel }) {
  const { renamed, select, selected, support, unit } = useWorkspace();
  const { id, name, colour, run, verdict, isLocked, isShown } = object;
  const { confidence } = object;
  const rename = () => {
    renamed.value = object;
  };
  return (
    <button
      type="button"
      class="select"
      aria-pressed={selected.value === object}
      title="Double-click to rename"
      onClick={() => select(id)}
      onDblClick={rename}
      onKeyDown={({ key }) => key === "F2" && rename()}
    >
      <span class="swatch" style={{ background: colour }} />
      <span class="name">{name}</span>
      {!isShown.value && <Icon name="hidden" />}
      {isLocked.value && <Icon name="locked" />}
      <span class="state">{stateOf(run.value, object, unit.value, support.value)}</span>
      <span class="confidence">
        {verdict.value !== null ? marks[verdict.value] : confidence === null ? "" : percent(confidence)}
      </span>
    </button>
  );
}

function NameField({ object }: { object: ObjectModel }) {
  const { rename, renamed } = useWorkspace();
  const { name } = object;
  const field = useRef<HTMLInputElement>(null);
  // At once: the next key belongs to the name.
  useLayoutEffect(() => {
    field.current?.focus();
    field.current?.select();
  }, []);
  return (
    <input
      class="rename"
      aria-label={`New name of ${name}`}
      value={name}
      ref={field}
      onKeyDown={({ key, currentTarget }) => {
        if (key === "Escape") currentTarget.value = name;
        if (key !== "Enter" && key !== "Escape") return;
        const row = currentTarget.parentElement;
        currentTarget.blur();
        // The focus would be lost with the field.
        requestAnimationFrame(() => row?.querySelector("button")?.focus());
      }}
      onBlur={({ currentTarget }) => {
        rename(object, currentTarget.value.trim() || name);
        renamed.value = null;
      }}
    />
  );
}
