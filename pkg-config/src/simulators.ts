/**
 * Scenes for physics simulators: rigid bodies of the objects that `alignScene` has found, as MJCF (MuJoCo), URDF (PyBullet)
 * and USD.
 *
 * The world is in metres and kilograms, with z up and the ground at z = 0. Its origin is the foot of the objects' centre.
 * @packageDocumentation
 */
export { type ErrorCode, type ErrorParts, Sim3AlignError } from "./error.js";
export type { MeshArrays } from "./input/types.js";
export type { WasmSource } from "./platform.js";
export type { ColorSamples } from "./prepared-mesh.js";
export type { Plane } from "./scene/types.js";
export type { Sim3Like } from "./sim3.js";
export { toMjcf } from "./simulators/mjcf.js";
export type { ConvexPart } from "./simulators/physics-module.js";
export {
  SIMULATOR_DEFAULTS,
  type SimulatorBody,
  type SimulatorObject,
  type SimulatorOptions,
  type SimulatorPose,
  type SimulatorScene,
  simulatorScene,
} from "./simulators/scene.js";
export { toUrdf } from "./simulators/urdf.js";
export { toUsd } from "./simulators/usd.js";
export type { Quaternion, Vector3 } from "./values.js";
