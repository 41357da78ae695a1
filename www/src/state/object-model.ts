/** An object of a scene: its mask, its mesh, and the state of its alignment. */
import { computed, type Signal, signal } from "@preact/signals";
import type { AlignmentByPreset, Contact, MeshArrays, Metrics, PoseErrors, Sim3AlignError, Stage } from "sim3align";
import type { Sim3Like, Vector3 } from "sim3align/conventions";
import { type Bounds, boundsOf, type PlacedBox, type Pose, placed, startPose } from "./pose.js";

/** The state of an alignment. */
export type Run =
  | { readonly state: "idle" }
  | { readonly state: "waiting" }
  | { readonly state: "running"; readonly stage: Stage | null; readonly fraction: number }
  | { readonly state: "done" }
  | { readonly state: "cancelled" }
  | { readonly state: "failed"; readonly error: Sim3AlignError | Error };

/** The result of an alignment, with any preset. The result of a scene also says what the object rests on. */
export type AnyAlignment = (PreciseAlignment | Omit<AlignmentByPreset["paper"], "input">) & {
  readonly contact?: Contact;
};

/** The result with the preset `precise`. */
export type PreciseAlignment = Omit<AlignmentByPreset["precise"], "input">;

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
  /** Centre and extent of the depth readings in the mask, metres. */
  visible: { centreM: Vector3; sizeM: number };
}

/** An object of a scene. The inputs are constant; signals hold the state. */
export class ObjectModel implements Readonly<ObjectParts> {
  readonly id: string;
  readonly colour: string;
  readonly mask: Uint8Array;
  readonly mesh: MeshArrays;
  readonly glb: Uint8Array | null;
  readonly truth: ObjectParts["truth"];
  readonly visible: ObjectParts["visible"];
  private readonly bounds: Bounds;
  /** The pose before any alignment. */
  readonly start: Pose;

  readonly title: Signal<string>;
  readonly isShown = signal(true);
  /** Whether alignments of the whole scene, and handles, leave the pose unchanged. */
  readonly isLocked = signal(false);
  /** Whether a person has accepted the present pose. */
  readonly isAccepted = signal(false);
  /** The known scale in metres per mesh unit, which every alignment keeps; null if it is free. */
  readonly knownScale = signal<number | null>(null);
  readonly run = signal<Run>({ state: "idle" });
  /** The last alignment, also after the pose was changed by hand. */
  readonly alignment = signal<AnyAlignment | null>(null);
  /** The current pose. */
  readonly pose: Signal<Pose>;
  /** Metrics of the current pose; null while they are computed. */
  readonly metrics = signal<Metrics | null>(null);
  /** Errors of the current pose, if the true pose is known. */
  readonly errors = signal<PoseErrors | null>(null);
  /** The bounding box at the current pose. */
  readonly box = computed<PlacedBox>(() => placed(this.bounds, this.pose.value.transform));

  constructor(parts: ObjectParts) {
    this.id = parts.id;
    this.title = signal(parts.name);
    this.colour = parts.colour;
    this.mask = parts.mask;
    this.mesh = parts.mesh;
    this.glb = parts.glb;
    this.truth = parts.truth;
    this.visible = parts.visible;
    this.bounds = boundsOf(parts.mesh);
    this.start = { transform: startPose(this.bounds, parts.visible), source: "start" };
    this.pose = signal<Pose>(this.start);
    // Another pose has to be accepted anew.
    this.pose.subscribe(() => {
      this.isAccepted.value = false;
    });
  }

  get name(): string {
    return this.title.value;
  }

  /** Makes the present scale the known one, or no scale. */
  lockScale(isLocked: boolean): void {
    this.knownScale.value = isLocked ? this.pose.peek().transform.scale : null;
  }

  /** Whether the object has a pose other than the start pose. */
  get isPlaced(): boolean {
    return this.pose.value.source !== "start";
  }

  /** The last alignment, if it is one of the preset `precise`. */
  get precise(): PreciseAlignment | null {
    const alignment = this.alignment.value;
    return alignment !== null && "confidence" in alignment ? alignment : null;
  }
}
