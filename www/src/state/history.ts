/**
 * Undo and redo: of poses with their alignments, of known sizes and decisions, and of the calibration and the support that
 * they are in.
 */
import { batch, computed, type Signal, signal } from "@preact/signals";
import type { Support } from "sim3align";
import type { Decision, ObjectModel, Verdict } from "./object-model.js";
import { type Nudge, nudged, type Pose } from "./pose.js";
import type { StatusState } from "./running.js";
import type { Scene, SceneState } from "./scene.js";

/** What steps restore. */
interface Snapshot {
  scene: Scene | null;
  support: Support | null;
  objects: Map<ObjectModel, Settled>;
}

interface Settled {
  pose: Pose;
  decision: Decision | null;
  knownScale: number | null;
}

const settled = ({ pose, decision, knownScale }: ObjectModel): Settled => ({
  ...{ pose: pose.peek(), decision: decision.peek(), knownScale: knownScale.peek() },
});

interface Step {
  object: ObjectModel;
  before: Snapshot;
  after: Snapshot;
}

/** Older steps are dropped. */
const MAX_STEPS = 200;

/** The undo steps of a scene. */
export function historyState(
  { objects, recalibrate, scene, select, support }: SceneState,
  { announce }: Pick<StatusState, "announce">,
) {
  const undoSteps = signal<readonly Step[]>([]);
  const redoSteps = signal<readonly Step[]>([]);

  const canUndo = computed(() => undoSteps.value.length > 0);
  const canRedo = computed(() => redoSteps.value.length > 0);

  const snapshot = (): Snapshot => ({
    scene: scene.peek(),
    support: support.peek(),
    objects: new Map(objects.peek().map((one) => [one, settled(one)] as const)),
  });

  /** Makes a change, as one step that can be undone. It is shown at this object. */
  function record(object: ObjectModel, change: () => void, before = snapshot()): void {
    batch(change);
    undoSteps.value = [...undoSteps.peek().slice(1 - MAX_STEPS), { object, before, after: snapshot() }];
    redoSteps.value = [];
  }

  /** Sets the pose of an object, as a step that can be undone. */
  function place(object: ObjectModel, after: Pose, from = object.pose.peek()): void {
    const before = snapshot();
    before.objects.set(object, { ...settled(object), pose: from });
    record(
      object,
      () => {
        object.pose.value = after;
      },
      before,
    );
  }

  /** The pose of an object after a change by hand. */
  function byHand(object: ObjectModel, change: Nudge): Pose {
    const transform = nudged(object.box.peek().centreM, object.pose.peek().transform, change);
    return { transform, source: "hand", alignment: object.alignment.peek() };
  }

  /** Decides about the present pose of an object, as a step that can be undone. */
  const decide = (object: ObjectModel, verdict: Verdict) =>
    record(object, () => {
      object.decision.value = { verdict, pose: object.pose.peek() };
    });

  /** Changes the pose of an object by hand, as a step of its own or as a part of the last one. */
  function nudge(object: ObjectModel, change: Nudge, continues = false): void {
    const last = undoSteps.peek().at(-1);
    place(object, byHand(object, change));
    if (!continues || last?.object !== object) return;
    const [after] = undoSteps.peek().slice(-1);
    undoSteps.value = [...undoSteps.peek().slice(0, -2), { ...last, ...(after && { after: after.after }) }];
  }

  /** Moves the last step from one list to the other, and shows the state on one side of it. */
  function move(from: Signal<readonly Step[]>, to: Signal<readonly Step[]>, side: "before" | "after"): void {
    const step = from.peek().at(-1);
    if (step === undefined) return;
    from.value = from.peek().slice(0, -1);
    to.value = [...to.peek(), step];
    const { scene: whole, support: plane, objects: states } = step[side];
    batch(() => {
      select(step.object.id);
      if (whole !== null && whole !== scene.peek()) recalibrate(whole);
      support.value = plane;
      for (const [object, { pose, decision, knownScale }] of states) {
        object.pose.value = pose;
        object.decision.value = decision;
        object.knownScale.value = knownScale;
      }
    });
    announce(`${side === "before" ? "Undid" : "Redid"} the change of ${step.object.name}.`);
  }

  const undo = () => move(undoSteps, redoSteps, "before");
  const redo = () => move(redoSteps, undoSteps, "after");

  // Another scene has other objects, so the steps of the previous one are cleared.
  objects.subscribe(() => {
    undoSteps.value = [];
    redoSteps.value = [];
  });

  return { canUndo, canRedo, record, place, decide, byHand, nudge, undo, redo };
}
