/** Meshes that are read, validated and decimated once for many calls. */

import { Sim3AlignError } from "./error.js";

/** A mesh for the core. */
export interface CoreMesh {
  positions: Float32Array;
  indices?: Uint32Array | Uint16Array;
  /** The id under which the core caches the mesh. If it is cached, the arrays are not read. */
  id?: number;
}

/** A mesh, and the id under which each thread caches the data derived from it. */
export interface KeptMesh {
  readonly id: number;
  readonly mesh: CoreMesh;
}

interface State extends KeptMesh {
  /** Functions to call when the mesh is disposed. */
  readonly drops: Set<() => void>;
}

const states = new WeakMap<object, State>();
let lastId = 0;

/** A new mesh id. */
export function nextMeshId(): number {
  lastId += 1;
  return lastId;
}

/**
 * A mesh that `Aligner.prepareMesh` has read, validated and decimated. It replaces the mesh in the inputs of all
 * aligners on this thread, with or without workers. Results are bit-identical to those with the mesh itself. Each
 * thread that uses it holds a copy until `dispose()`.
 */
export class PreparedMesh {
  /** @internal */
  constructor(kept: KeptMesh) {
    states.set(this, { ...kept, drops: new Set() });
  }

  /** Frees the mesh on this thread and in all workers. Later calls with it reject with `DISPOSED`. */
  dispose(): void {
    const drops = states.get(this)?.drops ?? [];
    states.delete(this);
    for (const drop of drops) drop();
  }

  /** Disposes the mesh at the end of the scope of a `using` declaration. */
  [Symbol.dispose](): void {
    this.dispose();
  }
}

/**
 * The arrays and the id of a prepared mesh.
 * @param drop called once when the mesh is disposed, even if it was passed repeatedly
 * @throws {@link Sim3AlignError} `DISPOSED`
 */
export function keptMesh(mesh: PreparedMesh, drop?: () => void): KeptMesh {
  const state = states.get(mesh);
  if (state === undefined) {
    throw new Sim3AlignError({
      code: "DISPOSED",
      argument: "mesh",
      found: "a disposed mesh",
      expected: "an active prepared mesh",
      remedy: "Prepare it again with prepareMesh(), or dispose it later.",
    });
  }
  if (drop !== undefined) state.drops.add(drop);
  return state;
}
