/** The frames of the files that generators of meshes write. */
import type { Sim3 } from "../input/sim3.js";
import type { Vector3 } from "../values/validation.js";

/** The frame of a file. */
export type GeneratorFrame = {
  /** The direction that is up, where the generator makes objects upright. */
  readonly up: Readonly<Sim3["translation"]>;
  /**
   * The horizontal direction to the camera of the photo; `null` where the generator turns each object as it sees fit.
   * How far the camera looks down is not known.
   */
  readonly front: Readonly<Sim3["translation"]> | null;
};

const frame = (up: Vector3, front: Vector3 | null = null): GeneratorFrame => ({ up, front });

/**
 * Which way is up, and which way is the camera, in the files that generators write, their meshes and their 3D Gaussians: SAM 3D Objects (`sam3d`), TRELLIS,
 * Hunyuan3D-2, TripoSR (`run.py`), InstantMesh (`run.py`) and Stable Fast 3D (`sf3d`). The guide "Scenes, and outputs of generators"
 * has the source of each.
 *
 * @example
 * // A level camera, and an object that stands upright:
 * await aligner.align(input, { meshUp: generatorFrames.trellis.mesh.up, cameraUp: [0, -1, 0] });
 */
export const generatorFrames: Readonly<
  Record<"sam3d" | "trellis", { readonly mesh: GeneratorFrame; readonly gaussians: GeneratorFrame }> &
    Record<"hunyuan3d" | "triposr" | "instantmesh" | "sf3d", { readonly mesh: GeneratorFrame }>
> = {
  sam3d: { mesh: frame([0, 1, 0]), gaussians: frame([0, 0, 1]) },
  trellis: { mesh: frame([0, 1, 0]), gaussians: frame([0, -1, 0]) },
  hunyuan3d: { mesh: frame([0, 1, 0]) },
  triposr: { mesh: frame([0, 0, 1], [1, 0, 0]) },
  instantmesh: { mesh: frame([0, 0, 1], [1, 0, 0]) },
  sf3d: { mesh: frame([0, 1, 0], [0, 0, -1]) },
};
