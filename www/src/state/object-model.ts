/** One object: its mask, its mesh, and what has become of it. */
import { computed, type Signal, signal } from "@preact/signals";
import type { Alignment, MeshArrays, Metrics, PoseErrors, Sim3AlignError, Stage } from "sim3align";
import type { Sim3Like } from "sim3align/conventions";
import { type Bounds, boundsOf, type PlacedBox, placed } from "./bounds.js";
import { type Pose, startPose } from "./pose.js";

/** How an alignment goes. */
export type Run =
  | { readonly state: "idle" }
  | { readonly state: "waiting" }
  | { readonly state: "running"; readonly stage: Stage | null; readonly fraction: number }
  | { readonly state: "done" }
  | { readonly state: "cancelled" }
  | { readonly state: "failed"; readonly error: Sim3AlignError | Error };

/** What an object is made of. */
export interface ObjectParts {
  id: string;
  name: string;
  colour: string;
  /** Of the depth map's size; 1 is the object. */
  mask: Uint8Array;
  mesh: MeshArrays;
  /** The mesh's file, where it is a GLB. */
  glb: Uint8Array | null;
  /** The true pose, where it is known, and the words about symmetry beside it. */
  truth: { transform: Sim3Like; symmetry: "none" | "auto" | "auto-revolution" } | null;
  /** The middle and the extent of its readings, metres. */
  seen: { middleM: [number, number, number]; sizeM: number };
}

/** An object of a scene; its parts stay, its state is in signals. */
export class ObjectModel implements Readonly<ObjectParts> {
  readonly id: string;
  readonly name: string;
  readonly colour: string;
  readonly mask: Uint8Array;
  readonly mesh: MeshArrays;
  readonly glb: Uint8Array | null;
  readonly truth: ObjectParts["truth"];
  readonly seen: ObjectParts["seen"];
  private readonly bounds: Bounds;
  /** Where the mesh is before anything is aligned. */
  readonly start: Pose;

  readonly run = signal<Run>({ state: "idle" });
  /** The last alignment, whatever has been done to the pose since. */
  readonly alignment = signal<Alignment | null>(null);
  /** Where the mesh is now. */
  readonly pose: Signal<Pose>;
  /** How well the present pose agrees with the observation; null while that is being found out. */
  readonly metrics = signal<Metrics | null>(null);
  /** How far the present pose is from the truth, where that is known. */
  readonly errors = signal<PoseErrors | null>(null);
  /** The box around the object at the present pose. */
  readonly box = computed<PlacedBox>(() => placed(this.bounds, this.pose.value.transform));

  constructor(parts: ObjectParts) {
    this.id = parts.id;
    this.name = parts.name;
    this.colour = parts.colour;
    this.mask = parts.mask;
    this.mesh = parts.mesh;
    this.glb = parts.glb;
    this.truth = parts.truth;
    this.seen = parts.seen;
    this.bounds = boundsOf(parts.mesh);
    this.start = { transform: startPose(this.bounds, parts.seen.middleM, parts.seen.sizeM), source: "start" };
    this.pose = signal<Pose>(this.start);
  }

  /** Whether it has been put anywhere. */
  get isPlaced(): boolean {
    return this.pose.value.source !== "start";
  }
}
