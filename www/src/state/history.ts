/**
 * Undo and redo: of poses with their alignments, of known sizes, decisions and masks, and of the calibration and the support
 * that they are in.
 */
import { batch, computed, type Signal, signal } from "@preact/signals";
import type { Support } from "sim3align";
import type { Inputs } from "./inputs.js";
import type { Decision, ObjectModel, Verdict, VisibleExtent } from "./object-model.js";
import type { OpenedState } from "./opened.js";
import { type Nudge, nudged, type Pose } from "./pose.js";
import type { StatusState } from "./running.js";
import type { Scene, SceneState } from "./scene.js";

/** What steps restore. */
interface Snapshot {
  scene: Scene | null;
  support: Support | null;
  files: Pick<Inputs, "objects" | "files">;
  objects: Map<ObjectModel, Settled>;
}

interface Settled {
  pose: Pose;
  decision: Decision | null;
  knownScale: number | null;
  shape: Uint8Array;
  visible: VisibleExtent;
}

const settled = ({ pose, decision, knownScale, shape, visible }: ObjectModel): Settled => ({
  ...{ pose: pose.peek(), decision: decision.peek(), knownScale: knownScale.peek() },
  ...{ shape: shape.peek(), visible: visible.peek() },
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
  { amend, inputs }: Pick<OpenedState, "amend" | "inputs">,
) {
  const undoSteps = signal<readonly Step[]>([]);
  const redoSteps = signal<readonly Step[]>([]);

  const canUndo = computed(() => undoSteps.value.length > 0);
  const canRedo = computed(() => redoSteps.value.length > 0);

  const snapshot = (): Snapshot => ({
    scene: scene.peek(),
    support: support.peek(),
    files: inputs.peek(),
    objects: new Map(objects.peek().map((one) => [one, settled(one)] as const)),
  });

  /** Makes a change, as one step that can be undone. It is shown at this object. */
  function record(object: ObjectModel, change: () => void, before = snapshot()): Step {
    batch(change);
    const step = { object, before, after: snapshot() };
    undoSteps.value = [...undoSteps.peek().slice(1 - MAX_STEPS), step];
    redoSteps.value = [];
    return step;
  }

  /** Makes the last step a part of the one before it, if that is `step`. */
  function join(step: Step | undefined): void {
    const [before, last] = undoSteps.peek().slice(-2);
    if (step === undefined || before !== step || last === undefined) return;
    undoSteps.value = [...undoSteps.peek().slice(0, -2), { ...step, after: last.after }];
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
    if (continues && last?.object === object) join(last);
  }

  /** Moves the last step from one list to the other, and shows the state on one side of it. */
  function move(from: Signal<readonly Step[]>, to: Signal<readonly Step[]>, side: "before" | "after"): void {
    const step = from.peek().at(-1);
    if (step === undefined) return;
    from.value = from.peek().slice(0, -1);
    to.value = [...to.peek(), step];
    const { scene: whole, support: plane, files, objects: states } = step[side];
    const now = scene.peek();
    batch(() => {
      select(step.object.id);
      const masks = files.objects.map(({ mask }) => mask);
      if (inputs.peek().objects.some(({ mask }, i) => mask !== masks[i])) {
        const objects = inputs.peek().objects.map((one, i) => ({ ...one, mask: masks[i] ?? null }));
        amend((one) => ({ ...one, objects, files: files.files }));
      }
      // A sample whose mask was corrected stays a scene of its own.
      if (whole !== null && now !== null && whole !== now)
        recalibrate({ ...whole, name: now.name, sample: now.sample });
      support.value = plane;
      for (const [object, { pose, decision, knownScale, shape, visible }] of states) {
        object.shape.value = shape;
        object.visible.value = visible;
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

  return { canUndo, canRedo, record, join, place, decide, byHand, nudge, undo, redo };
}
