/** Undo and redo of poses. */
import { computed, type Signal, signal } from "@preact/signals";
import type { ObjectModel } from "./object-model.js";
import { type Nudge, nudged, type Pose } from "./pose.js";
import type { SceneState } from "./scene.js";

interface Step {
  object: ObjectModel;
  before: Pose;
  after: Pose;
}

/** Older steps are dropped. */
const MAX_STEPS = 200;

/** The undo steps of a scene. */
export function historyState({ scene, select }: SceneState) {
  const undoSteps = signal<readonly Step[]>([]);
  const redoSteps = signal<readonly Step[]>([]);

  const canUndo = computed(() => undoSteps.value.length > 0);
  const canRedo = computed(() => redoSteps.value.length > 0);

  /** Sets the pose of an object, as a step that can be undone. */
  function place(object: ObjectModel, after: Pose, before = object.pose.peek()): void {
    object.pose.value = after;
    undoSteps.value = [...undoSteps.peek().slice(1 - MAX_STEPS), { object, before, after }];
    redoSteps.value = [];
  }

  /** Changes the pose of an object by hand. */
  function nudge(object: ObjectModel, change: Nudge): void {
    place(object, {
      transform: nudged(object.box.peek().centreM, object.pose.peek().transform, change),
      source: "hand",
    });
  }

  /** Moves the last step from one list to the other, and shows the pose on one side of it. */
  function move(from: Signal<readonly Step[]>, to: Signal<readonly Step[]>, side: "before" | "after"): void {
    const step = from.peek().at(-1);
    if (step === undefined) return;
    from.value = from.peek().slice(0, -1);
    to.value = [...to.peek(), step];
    select(step.object.id);
    step.object.pose.value = step[side];
  }

  const undo = () => move(undoSteps, redoSteps, "before");
  const redo = () => move(redoSteps, undoSteps, "after");

  // A new scene has new objects, so the steps of the previous one are cleared.
  scene.subscribe(() => {
    undoSteps.value = [];
    redoSteps.value = [];
  });

  return { canUndo, canRedo, place, nudge, undo, redo };
}
