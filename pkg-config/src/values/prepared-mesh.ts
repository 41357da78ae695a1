/** Meshes that are read, validated and decimated once for many calls. */
import type { ColorSamples } from "../types/files.js";
import { failure } from "./error.js";
import { brand, isRecord } from "./kinds.js";
import { copied } from "./transfer.js";

/** A mesh for the core. */
export interface CoreMesh {
  positions: Float32Array;
  indices?: Uint32Array | Uint16Array;
  /** sRGB-encoded red, green and blue per vertex. */
  colors?: Uint8Array;
  /** Colours at points of the surface, instead. */
  samples?: ColorSamples;
  /** Whether there are colours that could not be read. */
  lacksColors?: boolean;
  /** The point of the caller's file that is the origin here, if its coordinates are far from zero; see `origin.ts`. */
  fileOrigin?: readonly number[];
  /** How many copies of one mesh the file places. */
  copies?: number;
  /** The id under which the core caches the mesh. If it is cached, the arrays are not read. */
  id?: number;
}

/** A mesh, and the id under which each thread caches the data derived from it. */
export interface KeptMesh {
  readonly id: number;
  /** Its arrays, the reasons why it has no colours, and the content of its file that was not read. */
  readonly mesh: CoreMesh & { warnings: readonly string[]; unread?: readonly string[] | undefined };
}

/** Holds what threads derive from prepared meshes, by id. */
export interface MeshHolder {
  dropMesh(id: number): void;
}

interface State extends KeptMesh {
  /** Everything that may hold data of the mesh. */
  readonly holders: Set<MeshHolder>;
}

const states = new WeakMap<object, State | "disposed">();
let lastId = 0;

/** A new mesh id. */
export function nextMeshId(): number {
  lastId += 1;
  return lastId;
}

/**
 * A mesh that `Aligner.prepareMesh` has read, validated and decimated. It replaces the mesh in the inputs of all
 * aligners on this thread, with or without workers. Results are bit-identical to those with the mesh itself. Each
 * thread that uses it holds a copy until `dispose()`, and a second one after `alignScene`, `alignViews` or `track`.
 */
export class PreparedMesh {
  static {
    brand(PreparedMesh, "PreparedMesh");
  }

  /** @internal */
  constructor(kept: KeptMesh, holder: MeshHolder) {
    states.set(this, { ...kept, holders: new Set([holder]) });
  }

  /**
   * Frees the mesh on this thread, and in each worker with its next call; trackers that began with it keep their copy. Later calls
   * with it reject with `DISPOSED`.
   */
  dispose(): void {
    const state = states.get(this);
    if (state === undefined || state === "disposed") return;
    states.set(this, "disposed");
    for (const holder of state.holders) holder.dropMesh(state.id);
  }

  /** Disposes the mesh at the end of the scope of a `using` declaration. */
  [Symbol.dispose](): void {
    this.dispose();
  }
}

/**
 * The arrays and the id of a prepared mesh.
 * @param holder drops its data when the mesh is disposed
 * @throws {@link Sim3AlignError} `DISPOSED`
 */
function keptMesh(mesh: PreparedMesh, holder: MeshHolder): KeptMesh {
  const state = states.get(mesh);
  if (state === undefined) {
    const found = "one of another copy of sim3align, or a proxy of one";
    const remedy = "Prepare and align by one entry, and unwrap proxies.";
    throw failure("INVALID_ARGUMENT", "mesh", found, "one of this copy", remedy);
  }
  if (state === "disposed") {
    const remedy = "Prepare it again with prepareMesh(), or dispose it later.";
    throw failure("DISPOSED", "mesh", "a disposed mesh", "an active prepared mesh", remedy);
  }
  state.holders.add(holder);
  return state;
}

/** The data of a job, in which arrays have replaced a prepared mesh. */
export interface JobData<T> {
  data: T;
  /** The id of its prepared mesh. */
  meshId?: number | undefined;
  /** The data with the prepared mesh. */
  restored(data: T): T;
  /** Releases the prepared mesh at the end of the job. */
  release(): void;
}

/**
 * The input of a call as the data of a job: a prepared mesh is replaced by its arrays.
 * @param holder drops its data when the mesh is disposed
 * @param isCached whether the call takes it from a cache, by its id; otherwise, the arrays are copies, which may be moved
 * @throws {@link Sim3AlignError} `DISPOSED`
 */
export function withArrays<T>(input: T, holder: MeshHolder, isCached = true): JobData<T> {
  const prepared = isRecord(input) ? input.mesh : undefined;
  if (!(prepared instanceof PreparedMesh)) return { data: input, restored: (data) => data, release() {} };
  const { id, mesh } = keptMesh(prepared, holder);
  return {
    data: { ...input, mesh: isCached ? mesh : copied(mesh) },
    meshId: isCached ? id : undefined,
    restored: (data) => ({ ...data, mesh: prepared }),
    release() {
      // A call that began before the mesh was disposed may have left data of it behind.
      if (states.get(prepared) === "disposed") holder.dropMesh(id);
    },
  };
}
