/** An object of a scene: its mask, its mesh, and the state of its alignment. */
import { computed, type ReadonlySignal, type Signal, signal } from "@preact/signals";
import type {
  Alignment,
  MeshArrays,
  Metrics,
  PaperAlignment,
  PoseErrors,
  SceneAlignment,
  Sim3AlignError,
  Sim3Like,
  Stage,
} from "sim3align";
import type { Vector3 } from "sim3align/values/validation";
import { boundsOf, isResult, type PlacedBox, type Pose, placed, startPose, tightBoundsOf } from "./pose.js";

/** The state of an alignment. */
export type Run =
  | { readonly state: "idle" }
  | { readonly state: "waiting" }
  | { readonly state: "running"; readonly stage: Stage | null; readonly fraction: number }
  | { readonly state: "done" }
  | { readonly state: "cancelled" }
  | { readonly state: "failed"; readonly error: Sim3AlignError | Error };

/** What a person has decided about an object: its pose is right, or there is to be none. */
export type Verdict = "accepted" | "skipped" | "impossible";

export interface Decision {
  readonly verdict: Verdict;
  /** The pose at that time. */
  readonly pose: Pose;
}

/** The inputs of an object. */
export interface ObjectParts {
  id: string;
  name: string;
  colour: string;
  /** 1 is the object. Has the size of the depth map. */
  mask: Uint8Array;
  mesh: MeshArrays;
  /** The mesh's file if it is a GLB. */
  glb: Uint8Array | null;
  /** The true pose and the symmetry to compare with, if known. */
  truth: { transform: Sim3Like; symmetry: "none" | "auto" } | null;
  /** Where a generator has put it, if known. */
  initial?: Sim3Like | undefined;
}

/** Centre and extent of the depth readings in the mask of an object, metres. */
export interface VisibleExtent {
  centreM: Vector3;
  sizeM: number;
}

/** An object of a scene. The inputs are constant, except for its mask, which can be corrected; signals hold the state. */
export class ObjectModel implements Readonly<ObjectParts> {
  readonly id: string;
  readonly colour: string;
  readonly shape: Signal<Uint8Array>;
  readonly mesh: MeshArrays;
  readonly glb: Uint8Array | null;
  readonly truth: ObjectParts["truth"];
  readonly initial: ObjectParts["initial"];
  /** Changes with the calibration of the depth map. */
  readonly visible: Signal<VisibleExtent>;
  /** The pose before any alignment. */
  readonly start: ReadonlySignal<Pose>;

  readonly title: Signal<string>;
  readonly isShown = signal(true);
  /** Whether alignments of the whole scene, and handles, leave the pose unchanged. */
  readonly isLocked = signal(false);
  readonly decision = signal<Decision | null>(null);
  /** The decision that counts: another pose has to be accepted anew. */
  readonly verdict = computed<Verdict | null>(() => {
    const { verdict, pose } = this.decision.value ?? {};
    return verdict === undefined || (verdict === "accepted" && pose !== this.pose.value) ? null : verdict;
  });
  readonly isAccepted = computed(() => this.verdict.value === "accepted");
  /** What a person notes beside the decision. */
  readonly comment = signal("");
  /** The known scale in metres per mesh unit, which every alignment keeps; null if it is free. */
  readonly knownScale = signal<number | null>(null);
  readonly run = signal<Run>({ state: "idle" });
  /** The last alignment, also after the pose was changed by hand. */
  readonly alignment = computed<AnyAlignment | null>(() => this.pose.value.alignment ?? null);
  /** The current pose. */
  readonly pose: Signal<Pose>;
  readonly #isPlaced = computed(() => this.pose.value.source !== "start");
  /** Metrics of the current pose; null while they are computed. */
  readonly metrics = signal<Metrics | null>(null);
  /** Errors of the current pose, if the true pose is known. */
  readonly errors = signal<PoseErrors | null>(null);
  /** The smallest box around the object at the current pose. */
  readonly box = computed<PlacedBox>(() => placed(tightBoundsOf(this.mesh), this.pose.value.transform));

  constructor(parts: ObjectParts, visible: VisibleExtent) {
    this.id = parts.id;
    this.title = signal(parts.name);
    this.colour = parts.colour;
    this.shape = signal(parts.mask);
    this.mesh = parts.mesh;
    this.glb = parts.glb;
    this.truth = parts.truth;
    this.initial = parts.initial;
    this.visible = signal(visible);
    const bounds = boundsOf(parts.mesh);
    this.start = computed<Pose>(() => ({ transform: startPose(bounds, this.visible.value), source: "start" }));
    this.pose = signal<Pose>(this.start.peek());
  }

  get name(): string {
    return this.title.value;
  }

  get mask(): Uint8Array {
    return this.shape.value;
  }

  /** Makes the present scale the known one, or no scale. */
  lockScale(isLocked: boolean): void {
    this.knownScale.value = isLocked ? this.pose.peek().transform.scale : null;
  }

  /** Whether alignments of the whole scene leave the pose as it is, because a person has decided on it. */
  get isHeld(): boolean {
    return this.isLocked.value || this.verdict.value !== null || this.pose.value.source === "alternative";
  }

  /** Writes the pose in another unit. If it was accepted, it still is. */
  rebase(pose: Pose): void {
    const { isAccepted } = this;
    const wasAccepted = isAccepted.peek();
    this.pose.value = pose;
    if (wasAccepted) this.decision.value = { verdict: "accepted", pose };
  }

  /** Whether the object has a pose other than the start pose. */
  get isPlaced(): boolean {
    return this.#isPlaced.value;
  }

  /** The confidence in the present pose; null for one that no alignment has found. */
  get confidence(): number | null {
    return isResult(this.pose.value.source) ? (this.precise?.confidence ?? null) : null;
  }

  /** What to check in the pose of the alignment. */
  get doubt(): Doubt | null {
    return isResult(this.pose.value.source) ? doubtOf(this.alignment.value) : null;
  }

  /** The last alignment, if it is one of the preset `precise`. */
  get precise(): PreciseAlignment | null {
    const alignment = this.alignment.value;
    return alignment !== null && "confidence" in alignment ? alignment : null;
  }
}

/** What a person must check, however sure the search is: see {@link doubtOf}. */
export type Doubt = "size" | "turn";

/** Below this confidence in the choice among turns of equal shape, the turn needs a second look. */
const SURE_OF_TURN = 0.7;

/**
 * The size, if the unit of the depth map was assumed and gives the object an unusual one; the turn, if neither shape nor
 * colours decide it.
 */
export function doubtOf(alignment: AnyAlignment | null): Doubt | null {
  if (alignment?.warnings.some(({ code }) => code === "SIZE_DOUBTFUL") === true) return "size";
  const turn = alignment !== null && "turnConfidence" in alignment ? alignment.turnConfidence : null;
  return turn !== null && turn < SURE_OF_TURN ? "turn" : null;
}

/** The result of an alignment, with any preset. The result of a scene also says what the object rests on. */
export type AnyAlignment = (PreciseAlignment | Omit<PaperAlignment, "input">) & {
  readonly contact?: SceneAlignment["contact"];
};

/** The result with the preset `precise`. */
export type PreciseAlignment = Omit<Alignment, "input">;
