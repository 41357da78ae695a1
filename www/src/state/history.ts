/** Undo and redo of poses. */
import { computed, signal } from "@preact/signals";
import type { ObjectModel } from "./object-model.js";
import type { Pose } from "./pose.js";
import { scene, select } from "./scene.js";

interface Step {
  object: ObjectModel;
  before: Pose;
  after: Pose;
}

/** Steps that are kept at most. */
const MAX_STEPS = 200;

const done = signal<readonly Step[]>([]);
const undone = signal<readonly Step[]>([]);

export const canUndo = computed(() => done.value.length > 0);
export const canRedo = computed(() => undone.value.length > 0);

/** Puts an object somewhere, so that it can be undone. */
export function place(object: ObjectModel, after: Pose, before = object.pose.peek()): void {
  object.pose.value = after;
  done.value = [...done.peek().slice(1 - MAX_STEPS), { object, before, after }];
  undone.value = [];
}

export function undo(): void {
  const step = done.peek().at(-1);
  if (step === undefined) return;
  done.value = done.peek().slice(0, -1);
  undone.value = [...undone.peek(), step];
  show(step.object, step.before);
}

export function redo(): void {
  const step = undone.peek().at(-1);
  if (step === undefined) return;
  undone.value = undone.peek().slice(0, -1);
  done.value = [...done.peek(), step];
  show(step.object, step.after);
}

function show(object: ObjectModel, pose: Pose): void {
  select(object.id);
  object.pose.value = pose;
}

/** Steps are about objects: those of another scene are none. */
let shown = scene.peek();
scene.subscribe((now) => {
  if (now === shown) return;
  shown = now;
  done.value = [];
  undone.value = [];
});
