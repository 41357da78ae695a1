/** The decision about a result: accept it, fix it, go on to the next one. */
import { openNext, queue } from "../load/open.js";
import { gizmo } from "../state/display.js";
import type { ObjectModel } from "../state/object-model.js";
import { scene, select, selected } from "../state/scene.js";
import { announce } from "../state/status.js";

/** Accepts the pose of the selected object, and selects the next one that is open. */
export function accept(): void {
  const object = selected.peek();
  if (object === null || !object.isPlaced) return;
  object.isAccepted.value = true;
  const next = nextOpen(object);
  announce(`Accepted ${object.name}.${next === null ? " All objects are accepted." : ""}`);
  if (next !== null) select(next.id);
}

/** Shows the handles and the controls of the selected object. */
export function fix(): void {
  gizmo.value = gizmo.peek() ?? "translate";
  const panel = document.querySelector<HTMLDetailsElement>(".hand-panel");
  if (panel === null) return;
  panel.open = true;
  panel.scrollIntoView({ block: "nearest" });
  // Without a 3D view there are no handles.
  const buttons = [...panel.querySelectorAll<HTMLElement>("button:enabled")];
  buttons.find((button) => button.checkVisibility())?.focus();
}

/** Selects the next object that is not accepted yet, or else the next one; after the last one, opens the next scene. */
export async function next(): Promise<void> {
  const objects = scene.peek()?.objects ?? [];
  const object = selected.peek();
  if (object === null) return;
  const open = nextOpen(object);
  if (open === null && queue.peek().length > 0) return openNext();
  select((open ?? objects[(objects.indexOf(object) + 1) % objects.length])?.id ?? null);
}

function nextOpen(object: ObjectModel): ObjectModel | null {
  const objects = scene.peek()?.objects ?? [];
  const from = objects.indexOf(object);
  const after = [...objects.slice(from + 1), ...objects.slice(0, from)];
  return after.find(({ isAccepted }) => !isAccepted.value) ?? null;
}

export function Decision({ object }: { object: ObjectModel | null }) {
  const isAccepted = object?.isAccepted.value === true;
  const hasNext = (scene.value?.objects.length ?? 0) > 1 || queue.value.length > 0;
  return (
    <fieldset class="decision" disabled={object === null}>
      <legend class="visually-hidden">Decision</legend>
      <button type="button" id="accept" aria-pressed={isAccepted} aria-keyshortcuts="Enter" onClick={accept}>
        {isAccepted ? "✓ Accepted" : "Accept"}
      </button>
      <button type="button" id="fix" onClick={fix}>
        Fix
      </button>
      <button type="button" id="next" disabled={!hasNext} aria-keyshortcuts="N" onClick={next}>
        Next
      </button>
    </fieldset>
  );
}
