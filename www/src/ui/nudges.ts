/** Small changes of a pose, as buttons and as commands. */
import type { Vector3 } from "sim3align/conventions";
import type { ObjectModel } from "../state/object-model.js";
import { type Nudge, rotationAbout } from "../state/pose.js";

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
  legend: string;
  /** Before the titles of the buttons. */
  verb: string;
  nudges: readonly (readonly [title: string, symbol: string, change: (object: ObjectModel) => Nudge])[];
}

/** Camera frame of OpenCV: y down, z forward. */
export const nudgeGroups: readonly NudgeGroup[] = [
  {
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
    legend: "Scale by 2 %",
    verb: "",
    nudges: [
      ["Smaller", "−", scaleBy(1 / 1.02)],
      ["Larger", "+", scaleBy(1.02)],
    ],
  },
];
