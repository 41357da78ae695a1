/** Small changes of a pose, as buttons and as keys. */
import type { Vector3 } from "sim3align/values/validation";
import type { ObjectModel } from "../state/object-model.js";
import { type Nudge, rotationAbout } from "../state/pose.js";
import type { Workspace } from "../state/workspace.js";
import type { GizmoMode } from "../view3d/types.js";

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

export interface NudgeGroup {
  /** The handles that do the same. */
  mode: GizmoMode;
  legend: string;
  /** Before the titles of the buttons. */
  verb: string;
  nudges: readonly (readonly [title: string, symbol: string, change: (object: ObjectModel) => Nudge])[];
}

/** Camera frame of OpenCV: y down, z forward. */
export const nudgeGroups: readonly NudgeGroup[] = [
  {
    mode: "translate",
    legend: "Move in the camera view",
    verb: "Move ",
    nudges: [
      ["left", "←", moveBy(-1, 0, 0)],
      ["right", "→", moveBy(1, 0, 0)],
      ["up", "↑", moveBy(0, -1, 0)],
      ["down", "↓", moveBy(0, 1, 0)],
      ["nearer", "⊙", moveBy(0, 0, -1)],
      ["farther", "⊗", moveBy(0, 0, 1)],
    ],
  },
  {
    mode: "rotate",
    legend: "Rotate by 5°",
    verb: "Rotate ",
    nudges: [
      ["left", "↶", turnBy(5, 0, 1, 0)],
      ["right", "↷", turnBy(-5, 0, 1, 0)],
      ["backwards", "⤒", turnBy(5, 1, 0, 0)],
      ["forwards", "⤓", turnBy(-5, 1, 0, 0)],
      ["anticlockwise", "⟲", turnBy(-5, 0, 0, 1)],
      ["clockwise", "⟳", turnBy(5, 0, 0, 1)],
    ],
  },
  {
    mode: "scale",
    legend: "Scale by 2 %",
    verb: "",
    nudges: [
      ["Smaller", "−", scaleBy(1 / 1.02)],
      ["Larger", "+", scaleBy(1.02)],
    ],
  },
];

/** The key of each nudge of a group, while the handles of the group are shown. */
const stepKeys = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "PageDown", "PageUp"];

/** Whether the pose of an object can be changed in this way now. */
export const canNudge = ({ isRunning }: Workspace, object: ObjectModel, { mode }: NudgeGroup): boolean =>
  !isRunning.value && !object.isLocked.value && (mode !== "scale" || object.knownScale.value === null);

/** Changes the pose of the selected object as a key says. While the key is held down, that is one step to undo. */
export function nudgeByKey(workspace: Workspace, { key, repeat }: KeyboardEvent): void {
  const object = workspace.selected.peek();
  const group = nudgeGroups.find(({ mode }) => mode === workspace.gizmo.peek());
  const change = group?.nudges[stepKeys.indexOf(key)]?.[2];
  if (object === null || group === undefined || change === undefined || !canNudge(workspace, object, group)) return;
  workspace.nudge(object, change(object), repeat);
}
