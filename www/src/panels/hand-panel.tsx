/** Adjusting the pose by hand: handles, nudges, known size, refine, undo and redo. */
import type { Vector3 } from "sim3align/conventions";
import { refine } from "../run/align.js";
import { type Nudge, rotationAbout } from "../state/pose.js";
import type { Workspace } from "../state/workspace.js";
import { useWorkspace } from "../ui/workspace.js";
import { KnownSize } from "./known-size.js";
import { Numbers } from "./numbers.js";

const modes = [
  ["translate", "Move", "G"],
  ["rotate", "Rotate", "R"],
  ["scale", "Scale", "S"],
] as const;

/** Directions in the camera frame (OpenCV: y down, z forward). */
const moves: readonly [title: string, symbol: string, direction: Vector3][] = [
  ["left", "←", [-1, 0, 0]],
  ["right", "→", [1, 0, 0]],
  ["up", "↑", [0, -1, 0]],
  ["down", "↓", [0, 1, 0]],
  ["nearer", "⊙", [0, 0, -1]],
  ["farther", "⊗", [0, 0, 1]],
];

const settings = [
  ["snap", "snaps", "Snap"],
  ["local-axes", "isLocal", "Axes of the mesh"],
] as const;

const rotations: readonly [title: string, symbol: string, axis: Vector3, degrees: number][] = [
  ["left", "↶", [0, 1, 0], 5],
  ["right", "↷", [0, 1, 0], -5],
  ["backwards", "⤒", [1, 0, 0], 5],
  ["forwards", "⤓", [1, 0, 0], -5],
  ["anticlockwise", "⟲", [0, 0, 1], -5],
  ["clockwise", "⟳", [0, 0, 1], 5],
];

/** Moves, rotates or scales the selected object. */
function nudgeSelected({ nudge, selected }: Workspace, change: Nudge): void {
  const object = selected.peek();
  if (object !== null) nudge(object, change);
}

function move({ nudge, selected }: Workspace, direction: Vector3): void {
  const object = selected.peek();
  if (object === null) return;
  // Visible, but small compared with the mask.
  const step = Math.hypot(...object.box.peek().sizeM) / 50;
  nudge(object, { moveM: direction.map((x) => x * step) as Vector3 });
}

export function HandPanel() {
  const workspace = useWorkspace();
  const { canRedo, canUndo, gizmo, gizmoSettings, isRunning, redo, selected, space, undo } = workspace;
  const object = selected.value;
  const lockScale = object !== null && object.knownScale.value !== null;
  const isReady = object !== null && !isRunning.value && !object.isLocked.value;
  return (
    <details class="panel hand-panel" part="hand" open>
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
      <div class="row">
        {settings.map(([id, name, title]) => (
          <label key={id} class="check">
            <input
              id={id}
              type="checkbox"
              checked={gizmoSettings.value[name]}
              onChange={({ currentTarget }) => {
                gizmoSettings.value = { ...gizmoSettings.peek(), [name]: currentTarget.checked };
              }}
            />
            <span>{title}</span>
          </label>
        ))}
      </div>
      <details class="more">
        <summary>Nudge</summary>
        <Numbers object={object} isReady={isReady} />
        <fieldset class="steps" disabled={!isReady}>
          <legend>Move in the camera view</legend>
          {moves.map(([title, symbol, direction]) => (
            <button
              key={title}
              type="button"
              aria-label={`Move ${title}`}
              title={title}
              onClick={() => move(workspace, direction)}
            >
              {symbol}
            </button>
          ))}
        </fieldset>
        <fieldset class="steps" disabled={!isReady}>
          <legend>Rotate by 5°</legend>
          {rotations.map(([title, symbol, axis, degrees]) => (
            <button
              key={title}
              type="button"
              aria-label={`Rotate ${title}`}
              title={title}
              onClick={() => nudgeSelected(workspace, { rotation: rotationAbout(axis, degrees) })}
            >
              {symbol}
            </button>
          ))}
        </fieldset>
        <fieldset class="steps" disabled={!isReady || lockScale}>
          <legend>Scale by 2 %</legend>
          <button type="button" aria-label="Smaller" onClick={() => nudgeSelected(workspace, { scale: 1 / 1.02 })}>
            −
          </button>
          <button type="button" aria-label="Larger" onClick={() => nudgeSelected(workspace, { scale: 1.02 })}>
            +
          </button>
        </fieldset>
      </details>
      <KnownSize object={object} id="known-size" />
      <div class="row">
        {/* A disabled button would lose the focus while it runs. */}
        <button
          type="button"
          id="refine"
          aria-disabled={!isReady}
          aria-keyshortcuts="F"
          onClick={() => refine(workspace)}
        >
          Refine pose
        </button>
        <label class="check">
          <input
            id="lock-scale"
            type="checkbox"
            checked={lockScale}
            disabled={object === null}
            onChange={({ currentTarget }) => object?.lockScale(currentTarget.checked)}
          />
          <span>Lock scale</span>
        </label>
      </div>
      <div class="row">
        <button type="button" id="undo" aria-disabled={!canUndo.value} aria-keyshortcuts="Control+Z" onClick={undo}>
          Undo
        </button>
        <button
          type="button"
          id="redo"
          aria-disabled={!canRedo.value}
          aria-keyshortcuts="Control+Shift+Z"
          onClick={redo}
        >
          Redo
        </button>
      </div>
    </details>
  );
}
