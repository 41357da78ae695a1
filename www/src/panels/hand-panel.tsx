/** By hand: handles, nudges, a known size, refine, undo and redo. */
import type { Vector3 } from "sim3align/conventions";
import { isRunning, refine } from "../run/align.js";
import { gizmo } from "../state/display.js";
import { canRedo, canUndo, place, redo, undo } from "../state/history.js";
import { options, setOption } from "../state/options.js";
import { type Nudge, nudged, turn } from "../state/pose.js";
import { selected } from "../state/scene.js";
import { space } from "../views/space.js";
import { KnownSize } from "./known-size.js";

const modes = [
  ["translate", "Move", "G"],
  ["rotate", "Turn", "R"],
  ["scale", "Scale", "S"],
] as const;

/** Directions as the camera sees them (OpenCV: y is down, z is away). */
const moves: readonly [title: string, sign: string, direction: Vector3][] = [
  ["left", "←", [-1, 0, 0]],
  ["right", "→", [1, 0, 0]],
  ["up", "↑", [0, -1, 0]],
  ["down", "↓", [0, 1, 0]],
  ["nearer", "⊙", [0, 0, -1]],
  ["farther", "⊗", [0, 0, 1]],
];

const turns: readonly [title: string, sign: string, axis: Vector3, degrees: number][] = [
  ["left", "↶ y", [0, 1, 0], 5],
  ["right", "↷ y", [0, 1, 0], -5],
  ["backwards", "↶ x", [1, 0, 0], 5],
  ["forwards", "↷ x", [1, 0, 0], -5],
  ["anticlockwise", "↶ z", [0, 0, 1], -5],
  ["clockwise", "↷ z", [0, 0, 1], 5],
];

/** Moves, turns or scales the selected mesh a little. */
function nudge(how: Nudge): void {
  const object = selected.peek();
  if (object === null) return;
  place(object, { transform: nudged(object.box.peek().centerM, object.pose.peek().transform, how), source: "hand" });
}

function move(direction: Vector3): void {
  const object = selected.peek();
  if (object === null) return;
  // A fiftieth of the object, which is seen and does not leave the mask.
  const step = Math.hypot(...object.box.peek().sizeM) / 50;
  nudge({ moveM: direction.map((x) => x * step) as Vector3 });
}

export function HandPanel() {
  const object = selected.value;
  const { lockScale } = options.value;
  const isReady = object !== null && !isRunning.value;
  return (
    <details class="panel hand-panel" open>
      <summary>
        <h2>By hand</h2>
      </summary>
      <fieldset class="row" disabled={!isReady || space.value.kind !== "ready"}>
        <legend>Handles in the 3D view</legend>
        {modes.map(([mode, title, key]) => (
          <button
            key={mode}
            type="button"
            aria-pressed={gizmo.value === mode}
            aria-keyshortcuts={key}
            disabled={mode === "scale" && lockScale}
            onClick={() => {
              gizmo.value = gizmo.peek() === mode ? null : mode;
            }}
          >
            {title}
          </button>
        ))}
      </fieldset>
      <details class="more">
        <summary>Small steps</summary>
        <fieldset class="steps" disabled={!isReady}>
          <legend>Move, as the camera sees it</legend>
          {moves.map(([title, sign, direction]) => (
            <button
              key={title}
              type="button"
              aria-label={`Move ${title}`}
              title={title}
              onClick={() => move(direction)}
            >
              {sign}
            </button>
          ))}
        </fieldset>
        <fieldset class="steps" disabled={!isReady}>
          <legend>Turn by 5°</legend>
          {turns.map(([title, sign, axis, degrees]) => (
            <button
              key={title}
              type="button"
              aria-label={`Turn ${title}`}
              title={title}
              onClick={() => nudge({ rotation: turn(axis, degrees) })}
            >
              {sign}
            </button>
          ))}
        </fieldset>
        <fieldset class="steps" disabled={!isReady || lockScale}>
          <legend>Scale by 2 %</legend>
          <button type="button" aria-label="Smaller" onClick={() => nudge({ scale: 1 / 1.02 })}>
            −
          </button>
          <button type="button" aria-label="Larger" onClick={() => nudge({ scale: 1.02 })}>
            +
          </button>
        </fieldset>
      </details>
      <KnownSize object={object} />
      <div class="row">
        <button type="button" id="refine" disabled={!isReady} aria-keyshortcuts="F" onClick={refine}>
          Refine from here
        </button>
        <label class="check">
          <input
            id="lock-scale"
            type="checkbox"
            checked={lockScale}
            onChange={({ currentTarget }) => setOption("lockScale", currentTarget.checked)}
          />
          <span>Lock scale</span>
        </label>
      </div>
      <div class="row">
        <button type="button" id="undo" disabled={!canUndo.value} aria-keyshortcuts="Control+Z" onClick={undo}>
          Undo
        </button>
        <button type="button" id="redo" disabled={!canRedo.value} aria-keyshortcuts="Control+Shift+Z" onClick={redo}>
          Redo
        </button>
      </div>
    </details>
  );
}
