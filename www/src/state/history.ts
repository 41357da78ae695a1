/** Undo and redo of poses. */
import { computed, signal } from "@preact/signals";
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

  function undo(): void {
    const step = undoSteps.peek().at(-1);
    if (step === undefined) return;
    undoSteps.value = undoSteps.peek().slice(0, -1);
    redoSteps.value = [...redoSteps.peek(), step];
    show(step.object, step.before);
  }

  function redo(): void {
    const step = redoSteps.peek().at(-1);
    if (step === undefined) return;
    redoSteps.value = redoSteps.peek().slice(0, -1);
    undoSteps.value = [...undoSteps.peek(), step];
    show(step.object, step.after);
  }

  function show(object: ObjectModel, pose: Pose): void {
    select(object.id);
    object.pose.value = pose;
  }

  /** A new scene has new objects, so the steps of the previous one are cleared. */
  let current = scene.peek();
  scene.subscribe((next) => {
    if (next === current) return;
    current = next;
    undoSteps.value = [];
    redoSteps.value = [];
  });

  return { canUndo, canRedo, place, nudge, undo, redo };
}
