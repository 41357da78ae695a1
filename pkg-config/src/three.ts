/**
 * Alignments in three.js: place objects by a result, take meshes from a scene, and set up cameras like the one that took
 * the depth map.
 *
 * three.js itself is not imported: any object of the right shape works, of any version of three.js.
 * @packageDocumentation
 */

export { type ErrorCode, type ErrorParts, Sim3AlignError } from "./error.js";
export type { StatedCamera } from "./formats/pinhole.js";
export type { MeshArrays } from "./input/types.js";
export type { Sim3, Sim3Like } from "./sim3.js";
export { applyPinhole, cameraFromPinhole, type LensOptions, type ThreeCamera } from "./three/camera.js";
export { type MeshInputOptions, meshInputFromThree } from "./three/mesh-input.js";
export { applyToObject3D, type PoseOptions, transformFromObject3D } from "./three/pose.js";
export type {
  AttributeLike,
  GeometryLike,
  Matrix4Like,
  MeshTree,
  PerspectiveCameraLike,
  PlacedObject,
  PosableObject,
  QuaternionLike,
  Vector3Like,
} from "./three/types.js";
