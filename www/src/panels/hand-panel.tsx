/** Adjusting the pose by hand: handles, nudges, known size, refine, undo and redo. */
import type { Vector3 } from "sim3align/conventions";
import { refine } from "../run/align.js";
import type { ObjectModel } from "../state/object-model.js";
import { type Nudge, rotationAbout } from "../state/pose.js";
import { Check } from "../ui/controls.js";
import { useWorkspace } from "../ui/workspace.js";
import { KnownSize } from "./known-size.js";
import { Numbers } from "./numbers.js";

const modes = [
  ["translate", "Move", "G"],
  ["rotate", "Rotate", "R"],
  ["scale", "Scale", "S"],
] as const;

const settings = [
  ["snap", "snaps", "Snap"],
  ["local-axes", "isLocal", "Axes of the mesh"],
] as const;

/** A fiftieth of the object's size in a direction of the camera frame: visible, but small compared with the mask. */
const moveBy =
  (...direction: Vector3) =>
  ({ box }: ObjectModel): Nudge => {
    const step = Math.hypot(...box.peek().sizeM) / 50;
    return { moveM: direction.map((x) => x * step) as Vector3 };
  };

const turnBy =
  (degrees: number, ...axis: Vector3) =>
  (): Nudge => ({ rotation: rotationAbout(axis, degrees) });

const scaleBy = (scale: number) => (): Nudge => ({ scale });

interface Steps {
  legend: string;
  /** Before the titles of the buttons. */
  verb: string;
  buttons: readonly (readonly [title: string, symbol: string, change: (object: ObjectModel) => Nudge])[];
}

/** Buttons that change the pose (camera frame of OpenCV: y down, z forward). */
const steps: readonly Steps[] = [
  {
    legend: "Move in the camera view",
    verb: "Move ",
    buttons: [
      ["left", "←", moveBy(-1, 0, 0)],
      ["right", "→", moveBy(1, 0, 0)],
      ["up", "↑", moveBy(0, -1, 0)],
      ["down", "↓", moveBy(0, 1, 0)],
      ["nearer", "⊙", moveBy(0, 0, -1)],
      ["farther", "⊗", moveBy(0, 0, 1)],
    ],
  },
  {
    legend: "Rotate by 5°",
    verb: "Rotate ",
    buttons: [
      ["left", "↶", turnBy(5, 0, 1, 0)],
      ["right", "↷", turnBy(-5, 0, 1, 0)],
      ["backwards", "⤒", turnBy(5, 1, 0, 0)],
      ["forwards", "⤓", turnBy(-5, 1, 0, 0)],
      ["anticlockwise", "⟲", turnBy(-5, 0, 0, 1)],
      ["clockwise", "⟳", turnBy(5, 0, 0, 1)],
    ],
  },
  {
    legend: "Scale by 2 %",
    verb: "",
    buttons: [
      ["Smaller", "−", scaleBy(1 / 1.02)],
      ["Larger", "+", scaleBy(1.02)],
    ],
  },
];

export function HandPanel() {
  const workspace = useWorkspace();
  const { canRedo, canUndo, gizmo, gizmoSettings, isRunning, nudge, redo, selected, space, undo, unit } = workspace;
  const object = selected.value;
  const lockScale = object !== null && object.knownScale.value !== null;
  const isReady = object !== null && !isRunning.value && !object.isLocked.value;
  return (
    <details class="panel hand-panel" part="hand" open>
      <summary>
        <h2>By hand</h2>
      </summary>
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
        <summary>More</summary>
        <div class="row">
          {settings.map(([id, name, title]) => (
            <Check
              key={id}
              id={id}
              title={title}
              checked={gizmoSettings.value[name]}
              onCheck={(checked) => {
                gizmoSettings.value = { ...gizmoSettings.peek(), [name]: checked };
              }}
            />
          ))}
        </div>
        <Numbers object={object} isReady={isReady} />
        {steps.map(({ legend, verb, buttons }) => (
          <fieldset key={legend} class="steps" disabled={!isReady || (verb === "" && lockScale)}>
            <legend>{legend}</legend>
            {buttons.map(([title, symbol, change]) => (
              <button
                key={title}
                type="button"
                aria-label={verb + title}
                title={verb && title}
                onClick={() => object !== null && nudge(object, change(object))}
              >
                {symbol}
              </button>
            ))}
          </fieldset>
        ))}
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
        <Check
          id="lock-scale"
          title="Lock scale"
          checked={lockScale}
          disabled={object === null || unit.value !== null}
          onCheck={(checked) => object?.lockScale(checked)}
        />
      </div>
    </details>
  );
}
