/** Keyboard shortcuts: one table, which the help shows and the page obeys. */

import { alignAll, alignSelected, cancel, isRunning, refine } from "../run/align.js";
import { applyAlternative } from "../run/alternatives.js";
import { display3d, gizmo, largeView, layers, setLayer } from "../state/display.js";
import { redo, undo } from "../state/history.js";
import { options, setOption } from "../state/options.js";
import { scene, select, selected } from "../state/scene.js";
import { space } from "../views/space.js";
import { toggleHelp } from "./help.js";

interface Shortcut {
  /** As the browser names it; with "Mod+" for Control or Command. */
  key: string;
  /** As people read it. */
  shown: string;
  does: string;
  act(): unknown;
}

const gizmoMode = (mode: "translate" | "rotate" | "scale") => () => {
  gizmo.value = gizmo.peek() === mode ? null : mode;
};

const look = (from: "camera" | "orbit" | "top" | "side") => () => {
  const state = space.peek();
  if (state.kind === "ready") state.view.lookFrom(from);
};

function neighbour(step: number): void {
  const objects = scene.peek()?.objects ?? [];
  const now = selected.peek();
  const at = now === null ? 0 : objects.indexOf(now);
  select(objects[(at + step + objects.length) % objects.length]?.id ?? null);
}

const toggle3d = (name: "cloud" | "mesh" | "wireframe") => () => {
  display3d.value = { ...display3d.peek(), [name]: !display3d.peek()[name] };
};

export const shortcuts: readonly Shortcut[] = [
  { key: "a", shown: "A", does: "Align the selected object", act: alignSelected },
  { key: "A", shown: "Shift A", does: "Align all objects", act: alignAll },
  { key: "Escape", shown: "Esc", does: "Cancel; put the handles away", act: leave },
  { key: "f", shown: "F", does: "Refine from here", act: refine },
  { key: "g", shown: "G", does: "Handles to move", act: gizmoMode("translate") },
  { key: "r", shown: "R", does: "Handles to turn", act: gizmoMode("rotate") },
  { key: "s", shown: "S", does: "Handles to scale", act: gizmoMode("scale") },
  { key: "l", shown: "L", does: "Lock the scale", act: () => setOption("lockScale", !options.peek().lockScale) },
  { key: "Mod+z", shown: "Ctrl Z", does: "Undo", act: undo },
  { key: "Mod+Z", shown: "Ctrl Shift Z", does: "Redo", act: redo },
  { key: "Mod+y", shown: "Ctrl Y", does: "Redo", act: redo },
  { key: "[", shown: "[", does: "Previous object", act: () => neighbour(-1) },
  { key: "]", shown: "]", does: "Next object", act: () => neighbour(1) },
  { key: "c", shown: "C", does: "Look from the camera", act: look("camera") },
  { key: "o", shown: "O", does: "Look from a little aside", act: look("orbit") },
  { key: "t", shown: "T", does: "Look from above", act: look("top") },
  { key: "w", shown: "W", does: "Wireframe", act: toggle3d("wireframe") },
  { key: "p", shown: "P", does: "Points on or off", act: toggle3d("cloud") },
  { key: "m", shown: "M", does: "Mesh on or off", act: toggle3d("mesh") },
  { key: "d", shown: "D", does: "Depth difference", act: () => setLayer("difference", !layers.peek().difference) },
  { key: "b", shown: "B", does: "Before and after", act: () => setLayer("wipe", layers.peek().wipe < 0.5 ? 1 : 0) },
  { key: "z", shown: "Z", does: "Zoom to the objects", act: () => setLayer("zoom", !layers.peek().zoom) },
  { key: "v", shown: "V", does: "Swap the views", act: swapViews },
  { key: "0", shown: "0 to 9", does: "The result, and its alternatives", act: () => {} },
  { key: "?", shown: "?", does: "This help", act: toggleHelp },
];

function leave(): void {
  if (isRunning.peek()) cancel();
  else gizmo.value = null;
}

function swapViews(): void {
  largeView.value = largeView.peek() === "space" ? "image" : "space";
}

/** Whether somebody types into a field. */
const isTyping = (target: EventTarget | null) =>
  target instanceof HTMLElement &&
  target.matches('input:not([type="checkbox"], [type="radio"], [type="range"]), select, textarea');

function onKey(event: KeyboardEvent): void {
  const { key, ctrlKey, metaKey, altKey, target } = event;
  if (
    altKey ||
    event.defaultPrevented ||
    isTyping(target) ||
    document.querySelector("dialog[open], :popover-open") !== null
  )
    return;
  const isMod = ctrlKey || metaKey;
  if (!isMod && /^\d$/.test(key)) {
    const object = selected.peek();
    if (object !== null) applyAlternative(object, Number(key) - 1);
    return;
  }
  const found = shortcuts.find((shortcut) => shortcut.key === `${isMod ? "Mod+" : ""}${key}`);
  if (found === undefined) return;
  // Escape closes what is open, too.
  if (key !== "Escape") event.preventDefault();
  found.act();
}

/** Listens, until the function that it returns is called. */
export function listenToKeys(): () => void {
  addEventListener("keydown", onKey);
  return () => removeEventListener("keydown", onKey);
}
