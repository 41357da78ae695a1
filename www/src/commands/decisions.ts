/** Decisions about results: accept one, skip it, fix it, go on to the next one. */
import type { ObjectModel, Verdict } from "../state/object-model.js";
import { isDoubtful, judged } from "../state/progress.js";
import type { Workspace } from "../state/workspace.js";

const decided: { readonly [V in Verdict]: string } = {
  accepted: "Accepted",
  skipped: "Skipped",
  impossible: "Impossible:",
};

/** Decides about the selected object, and selects the next one that is open. */
export const decideOn = (verdict: Verdict) => (workspace: Workspace) => {
  const { announce, decide, objects, select, selected } = workspace;
  const object = selected.peek();
  if (object === null || (verdict === "accepted" && !object.isPlaced)) return;
  if (object.verdict.peek() !== verdict) decide(object, verdict);
  const others = objects.peek();
  const isAll = others.every((one) => one.verdict.peek() !== null);
  const isInVideo = workspace.video.peek() !== null;
  const all = ` All objects are ${others.every(({ isAccepted }) => isAccepted.peek()) ? "accepted" : "decided on"}.`;
  const what = isInVideo ? `frame ${workspace.frameIndex.peek() + 1}` : object.name;
  announce(`${decided[verdict]} ${what}.${isAll && !isInVideo ? all : ""}`);
  const next = [...after(others, object), ...others].find((one) => one.verdict.peek() === null);
  if (next !== undefined) select(next.id);
  else if (isInVideo) workspace.fileActions.peek()?.next("frame");
};

/** Objects that are open, whose poses nothing puts in doubt, and that are at least this sure. */
export const sureOf = (objects: readonly ObjectModel[], least: number) =>
  objects.filter(
    ({ verdict, confidence, doubt }) => verdict.value === null && doubt === null && (confidence ?? 0) >= least,
  );

/** Accepts all of these, as one step that can be undone. */
export function acceptSure({ announce, objects, record }: Workspace, least: number): void {
  const sure = sureOf(objects.peek(), least);
  const [first] = sure;
  if (first === undefined) return;
  record(first, () => {
    for (const { decision, pose } of sure) decision.value = { verdict: "accepted", pose: pose.peek() };
  });
  announce(`Accepted ${sure.length} objects. Undo takes it back.`);
}

export const accept = decideOn("accepted");

const after = (objects: readonly ObjectModel[], object: ObjectModel) => objects.slice(objects.indexOf(object) + 1);

/** Shows the handles and the controls of the selected object. On small screens, these come together. */
export function fix({ gizmo, largeView, space }: Workspace, { currentTarget }: Event): void {
  gizmo.value = gizmo.peek() ?? "translate";
  if (space.peek().kind === "ready") largeView.value = "space";
  const root = (currentTarget as Element).getRootNode() as Document | ShadowRoot;
  // The layout changes with the handles.
  requestAnimationFrame(() => {
    for (const part of [".space", ".handles"]) root.querySelector(part)?.scrollIntoView({ block: "nearest" });
    // Without a 3D view there are no handles.
    const first = root.querySelector<HTMLElement>(".handles button:enabled, #refine");
    first?.focus({ preventScroll: true });
  });
}

/**
 * Goes on to what needs a person: a later object of the scene, or another scene. Without any, to what is open, and then to
 * whatever follows.
 */
export function next(workspace: Workspace): unknown {
  const { fileActions, objects, select, selected } = workspace;
  const object = selected.peek();
  if (object === null) return;
  const all = objects.peek();
  const rest = after(all, object);
  const isDoubt = (one: ObjectModel) => isDoubtful(judged(one));
  const isOpen = (one: ObjectModel) => one.verdict.peek() === null;
  const files = fileActions.peek();
  for (const isWanted of [isDoubt, isOpen]) {
    const later = rest.find(isWanted);
    if (later !== undefined) return select(later.id);
    if (files?.next(isWanted === isDoubt ? "doubtful" : "open")) return;
    const earlier = all.find((one) => one !== object && isWanted(one));
    if (earlier !== undefined) return select(earlier.id);
  }
  if (rest[0] === undefined && files?.next("any")) return;
  select((rest[0] ?? all[0])?.id ?? null);
}
