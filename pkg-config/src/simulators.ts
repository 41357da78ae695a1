/**
 * Scenes for physics simulators: rigid bodies of the objects that `alignScene` has found, as MJCF (MuJoCo), URDF (PyBullet)
 * and USD.
 *
 * The world is in metres and kilograms, with z up and the ground at z = 0. Its origin is the foot of the objects' centre.
 * @packageDocumentation
 */

export { toMjcf } from "./simulators/mjcf.js";
export {
  type ConvexPart,
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
export { Sim3AlignError } from "./values/error.js";
