/** The decision about a result: accept it, fix it, go on to the next one. */
import type { ObjectModel } from "../state/object-model.js";
import type { Workspace } from "../state/workspace.js";
import { useWorkspace } from "../ui/workspace.js";

/** Accepts the pose of the selected object, and selects the next one that is open. */
export function accept(workspace: Workspace): void {
  const { acceptPose, announce, select, selected } = workspace;
  const object = selected.peek();
  if (object === null || !object.isPlaced) return;
  if (!object.isAccepted.peek()) acceptPose(object);
  const next = nextOpen(workspace, object);
  announce(`Accepted ${object.name}.${next === null ? " All objects are accepted." : ""}`);
  if (next !== null) select(next.id);
}

/** Shows the handles and the controls of the selected object. */
export function fix({ gizmo }: Workspace, { currentTarget }: Event): void {
  gizmo.value = gizmo.peek() ?? "translate";
  const root = (currentTarget as Element).getRootNode() as Document | ShadowRoot;
  const panel = root.querySelector(".hand-panel");
  panel?.scrollIntoView({ block: "nearest" });
  // Without a 3D view there are no handles.
  panel?.querySelector<HTMLElement>(".handles button:enabled, #refine")?.focus();
}

/** Selects the next object that is not accepted yet, or else the next one; after the last one, opens the next scene. */
export function next(workspace: Workspace): void {
  const { fileActions, list, scene, select, selected } = workspace;
  const objects = scene.peek()?.objects ?? [];
  const object = selected.peek();
  if (object === null) return;
  const open = nextOpen(workspace, object);
  if (open === null && list.peek().length > 1) fileActions.peek()?.next();
  else select((open ?? objects[(objects.indexOf(object) + 1) % objects.length])?.id ?? null);
}

function nextOpen({ scene }: Workspace, object: ObjectModel): ObjectModel | null {
  const objects = scene.peek()?.objects ?? [];
  const from = objects.indexOf(object);
  const after = [...objects.slice(from + 1), ...objects.slice(0, from)];
  return after.find(({ isAccepted }) => !isAccepted.value) ?? null;
}

export function Decision({ object }: { object: ObjectModel | null }) {
  const workspace = useWorkspace();
  const { list, scene } = workspace;
  const isAccepted = object?.isAccepted.value === true;
  const hasNext = (scene.value?.objects.length ?? 0) > 1 || list.value.length > 1;
  return (
    <fieldset class="decision" disabled={object === null}>
      <legend class="visually-hidden">Decision</legend>
      <button
        type="button"
        id="accept"
        aria-pressed={isAccepted}
        aria-keyshortcuts="Enter"
        onClick={() => accept(workspace)}
      >
        {isAccepted ? "✓ Accepted" : "Accept"}
      </button>
      <button type="button" id="fix" onClick={(event) => fix(workspace, event)}>
        Fix
      </button>
      <button type="button" id="next" disabled={!hasNext} aria-keyshortcuts="N" onClick={() => next(workspace)}>
        Next
      </button>
    </fieldset>
  );
}
