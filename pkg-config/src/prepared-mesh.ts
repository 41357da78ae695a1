/** Meshes that are read, checked and decimated once, and used in many calls. */

import { Sim3AlignError } from "./error.js";

/** A mesh as the core takes it. */
export interface CoreMesh {
  positions: Float32Array;
  indices?: Uint32Array | Uint16Array;
  /** The number under which the core keeps the mesh. Where it does already, the arrays are not read. */
  id?: number;
}

/** A mesh with the number under which each thread keeps what it has derived from it. */
export interface KeptMesh {
  readonly id: number;
  readonly mesh: CoreMesh;
}

interface State extends KeptMesh {
  /** What to do when the mesh is disposed. */
  readonly drops: Set<() => void>;
}

const states = new WeakMap<object, State>();
let lastId = 0;

/** A new number for a mesh. */
export function nextMeshId(): number {
  lastId += 1;
  return lastId;
}

/**
 * A mesh that `Aligner.prepareMesh` has read, checked and decimated. It takes the place of the mesh in the inputs of all
 * aligners on this thread, with or without workers. Results are the same to the bit as with the mesh itself. Each thread
 * that uses it keeps a copy until `dispose()`.
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

  /** Disposes the mesh at the end of a `using` declaration's scope. */
  [Symbol.dispose](): void {
    this.dispose();
  }
}

/**
 * The arrays and the number of a prepared mesh.
 * @param drop called when the mesh is disposed, once however often it is passed
 * @throws {@link Sim3AlignError} `DISPOSED`
 */
export function keptMesh(mesh: PreparedMesh, drop?: () => void): KeptMesh {
  const state = states.get(mesh);
  if (state === undefined) {
    throw new Sim3AlignError({
      code: "DISPOSED",
      argument: "mesh",
      found: "a disposed mesh",
      expected: "a prepared mesh in use",
      remedy: "Prepare it again with prepareMesh(), or dispose it later.",
    });
  }
  if (drop !== undefined) state.drops.add(drop);
  return state;
}
