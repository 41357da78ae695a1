/** The frames of the files that generators of meshes write. */
import type { Vector3 } from "../values.js";

/** The frame of a file. */
export interface GeneratorFrame {
  /** The direction that is up, where the generator makes objects upright. */
  up: Vector3;
  /**
   * The horizontal direction to the camera of the photo; `null` where the generator turns each object as it sees fit.
   * How far the camera looks down is not known.
   */
  front: Vector3 | null;
}

const y = { up: [0, 1, 0], front: null } satisfies GeneratorFrame;
const z = { up: [0, 0, 1], front: [1, 0, 0] } satisfies GeneratorFrame;

/**
 * Which way is up, and which way is the camera, in the files that generators write: SAM 3D Objects (`sam3d`), TRELLIS,
 * Hunyuan3D-2, TripoSR (`run.py`), InstantMesh (`run.py`) and Stable Fast 3D (`sf3d`). `mesh` is the mesh file, `gaussians`
 * the PLY of 3D Gaussians. The guide "Meshes of generators" has the source of each.
 *
 * @example
 * // A level camera, and an object that stands upright:
 * await aligner.align(input, { meshUp: generatorFrames.trellis.mesh.up, cameraUp: [0, -1, 0] });
 */
export const generatorFrames = {
  sam3d: { mesh: y, gaussians: { up: [0, 0, 1], front: null } },
  trellis: { mesh: y, gaussians: { up: [0, -1, 0], front: null } },
  hunyuan3d: { mesh: y },
  triposr: { mesh: z },
  instantmesh: { mesh: z },
  sf3d: { mesh: { up: [0, 1, 0], front: [0, 0, -1] } },
} as const satisfies Readonly<
  Record<string, { readonly mesh: Readonly<GeneratorFrame>; readonly gaussians?: Readonly<GeneratorFrame> }>
>;
