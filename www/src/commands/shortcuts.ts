/** The commands with keys, of the page and of an embedded element. The help lists them. */

import { alignAll, alignSelected, applyAlternative, refine } from "../alignment/align.js";
import type { Workspace } from "../state/workspace.js";
import { accept, decideOn, next } from "./decisions.js";
import { nudgeByKey } from "./nudges.js";

export interface Command {
  /** `KeyboardEvent.key`, after "Mod+" if it is pressed with Control or Command. */
  key: string;
  /** The key as the help shows it. */
  title: string;
  about: string;
  /** Whether it changes a pose or a decision, which a read-only element does not. */
  changes?: true;
  act(workspace: Workspace): unknown;
}

const toggleHandles =
  (mode: "translate" | "rotate" | "scale") =>
  ({ gizmo }: Workspace) => {
    gizmo.value = gizmo.peek() === mode ? null : mode;
  };

const lookFrom =
  (from: "camera" | "orbit" | "top" | "side") =>
  ({ space }: Workspace) => {
    const state = space.peek();
    if (state.kind === "ready") state.view.lookFrom(from, from === "camera");
  };

const selectNeighbour =
  (step: number) =>
  ({ scene, select, selected }: Workspace): void => {
    const objects = scene.peek()?.objects ?? [];
    const current = selected.peek();
    const index = current === null ? 0 : objects.indexOf(current);
    select(objects[(index + step + objects.length) % objects.length]?.id ?? null);
  };

const toggle3d =
  (name: "cloud" | "mesh" | "wireframe" | "planes") =>
  ({ display3d }: Workspace) => {
    display3d.value = { ...display3d.peek(), [name]: !display3d.peek()[name] };
  };

const toggleLayer =
  (name: "difference" | "zoom") =>
  ({ layers, setLayer }: Workspace) =>
    setLayer(name, !layers.peek()[name]);

export const commands: readonly Command[] = [
  { key: "a", changes: true, title: "A", about: "Align the selected object", act: alignSelected },
  { key: "A", changes: true, title: "Shift A", about: "Align all objects", act: alignAll },
  { key: "Escape", title: "Esc", about: "Cancel; hide the handles", act: cancelOrHideHandles },
  { key: "f", changes: true, title: "F", about: "Refine from the current pose", act: refine },
  { key: "g", changes: true, title: "G", about: "Handles to move", act: toggleHandles("translate") },
  { key: "r", changes: true, title: "R", about: "Handles to rotate", act: toggleHandles("rotate") },
  { key: "s", changes: true, title: "S", about: "Handles to scale", act: toggleHandles("scale") },
  {
    key: "ArrowLeft",
    changes: true,
    title: "← → ↑ ↓ PgUp PgDn",
    about: "Move, rotate or scale in steps, with handles shown",
    act: () => {},
  },
  { key: "l", changes: true, title: "L", about: "Lock the scale", act: toggleScaleLock },
  { key: "Mod+z", changes: true, title: "Ctrl Z", about: "Undo", act: ({ undo }) => undo() },
  { key: "Mod+Z", changes: true, title: "Ctrl Shift Z", about: "Redo", act: ({ redo }) => redo() },
  { key: "Mod+y", changes: true, title: "Ctrl Y", about: "Redo", act: ({ redo }) => redo() },
  { key: "Enter", changes: true, title: "Enter", about: "Accept the pose", act: accept },
  {
    key: "Mod+Enter",
    changes: true,
    title: "Ctrl Enter",
    about: "Accept the pose, with the focus on any button",
    act: accept,
  },
  { key: "x", changes: true, title: "X", about: "Skip the object", act: decideOn("skipped") },
  { key: "i", changes: true, title: "I", about: "Mark the object as impossible", act: decideOn("impossible") },
  { key: "n", title: "N", about: "Next that needs a person", act: next },
  { key: "k", title: "K", about: "Previous object", act: selectNeighbour(-1) },
  { key: "j", title: "J", about: "Next object", act: selectNeighbour(1) },
  { key: "c", title: "C", about: "Camera view", act: lookFrom("camera") },
  { key: "o", title: "O", about: "Three-quarter view", act: lookFrom("orbit") },
  { key: "t", title: "T", about: "Top view", act: lookFrom("top") },
  { key: "e", title: "E", about: "Side view", act: lookFrom("side") },
  { key: "q", title: "Q", about: "Top, side and front views, to drag in", act: toggle3d("planes") },
  { key: "w", title: "W", about: "Wireframe", act: toggle3d("wireframe") },
  { key: "p", title: "P", about: "Show or hide the points", act: toggle3d("cloud") },
  { key: "m", title: "M", about: "Show or hide the mesh", act: toggle3d("mesh") },
  { key: "d", title: "D", about: "Depth difference", act: toggleLayer("difference") },
  {
    key: "b",
    title: "B",
    about: "Before or after",
    act: ({ layers, setLayer }) => setLayer("wipe", layers.peek().wipe < 0.5 ? 1 : 0),
  },
  { key: "z", title: "Z", about: "Zoom to the objects", act: toggleLayer("zoom") },
  { key: "v", title: "V", about: "Swap the views", act: swapViews },
  {
    key: "0",
    changes: true,
    title: "0 to 9",
    about: "The result (0) and its alternatives",
    act: () => {},
  },
];

function toggleScaleLock({ selected, unit }: Workspace): void {
  const object = selected.peek();
  // In an unknown unit, no scale is known.
  if (unit.peek() === null) object?.lockScale(object.knownScale.peek() === null);
}

function cancelOrHideHandles({ cancel, gizmo, isRunning }: Workspace): void {
  if (isRunning.peek()) cancel();
  else gizmo.value = null;
}

function swapViews({ largeView }: Workspace): void {
  largeView.value = largeView.peek() === "space" ? "image" : "space";
}

/** Whether key events go to a text field. */
const isTyping = (target: EventTarget | null) =>
  target instanceof HTMLElement &&
  target.matches('input:not([type="checkbox"], [type="radio"], [type="range"]), select, textarea');

function onKey(workspace: Workspace, known: readonly Command[], event: KeyboardEvent): void {
  const { ctrlKey, metaKey, altKey, shiftKey, target } = event;
  // Caps Lock makes no other commands of letters.
  const letter = shiftKey ? event.key.toUpperCase() : event.key.toLowerCase();
  const key = event.key.length === 1 ? letter : event.key;
  if (altKey || event.defaultPrevented || document.querySelector("dialog[open], :popover-open") !== null) return;
  const isMod = ctrlKey || metaKey;
  const listed = /^\d$/.test(key) ? "0" : /^(Arrow|Page)/.test(key) ? "ArrowLeft" : key;
  const command = known.find(({ key: own }) => own === `${isMod ? "Mod+" : ""}${listed}`);
  if (command?.changes && workspace.isReadonly.peek()) return;
  if (isTyping(target)) return;
  // Enter presses the button that has the focus; the 3D view has no use for it.
  const isOfPage = target === document.body || target instanceof HTMLCanvasElement;
  if (key === "Enter" && !isMod && !isOfPage) return;
  if (command?.key === "ArrowLeft") {
    // Sliders have these keys, too; and without handles, they scroll.
    if (workspace.gizmo.peek() === null || target instanceof HTMLInputElement) return;
    event.preventDefault();
    // Loaded from the start: the next key can change the handles.
    nudgeByKey(workspace, event);
    return;
  }
  if (command?.key === "0") {
    const object = workspace.selected.peek();
    if (object !== null) applyAlternative(workspace, object, Number(key) - 1);
    return;
  }
  if (command === undefined) return;
  // Escape also closes dialogs and popovers.
  if (key !== "Escape") event.preventDefault();
  command.act(workspace);
}

/** Starts listening for keys, by default anywhere on the page. Call the returned function to stop. */
export function listenToKeys(
  workspace: Workspace,
  root: EventTarget = globalThis,
  known: readonly Command[] = commands,
): () => void {
  const listener = (event: Event) => onKey(workspace, known, event as KeyboardEvent);
  // Before the 3D view, which turns by arrows.
  root.addEventListener("keydown", listener, true);
  return () => root.removeEventListener("keydown", listener, true);
}
