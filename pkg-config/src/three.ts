/**
 * Alignments in three.js: places objects, extracts meshes from a scene, and sets camera intrinsics.
 *
 * three.js is not imported: objects of any version of three.js work, and any others of the same shape.
 * @packageDocumentation
 */

export { applyPinhole, cameraFromPinhole, type LensOptions, type ThreeCamera } from "./three/camera.js";
export { meshInputFromThree } from "./three/mesh-input.js";
export { applyToObject3D, type PoseOptions, transformFromObject3D } from "./three/pose.js";
export type {
  GeometryLike,
  MeshTree,
  PerspectiveCameraLike,
  PlacedObject,
  PosableObject,
} from "./three/types.js";
export { Sim3AlignError } from "./values/error.js";
