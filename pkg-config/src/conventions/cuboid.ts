/** Cuboids for annotation tools. */

import type { Sim3 } from "../input/sim3.js";
import { finiteNumbers, oneOf, optionsOf, positive, record, type Vector3, vector3 } from "../values/validation.js";
import { type CameraFrame, turnTo } from "./frames.js";
import type { OrientedBoundingBox } from "./oriented-bounding-box.js";
import {
  column,
  cross,
  dot,
  fromColumns,
  type Matrix3,
  product,
  quaternionOf,
  rotationFromQuaternion,
  turned,
} from "./rotation.js";

/** A direction along an axis of a mesh. */
export type MeshAxis = "x" | "-x" | "y" | "-y" | "z" | "-z";

/** Options of {@link toCuboid}. */
export interface CuboidOptions {
  /** The frame of centre and quaternion. Default: "ros" (x forward, y left, z up). */
  frame?: CameraFrame | undefined;
  /** The axis of the box that points to the front of the object. Default: "z", as in glTF. */
  front?: MeshAxis | undefined;
  /** The axis of the box that points up. Default: "y", as in glTF. */
  up?: MeshAxis | undefined;
}

/** A cuboid: x along its length, to the front of the object; y along its width, to the left; z along its height. */
export type Cuboid = {
  /** In metres. */
  center: Sim3["translation"];
  /** Length, width and height, along the cuboid's x, y and z, in metres. */
  size: Sim3["translation"];
  /** Frame from cuboid: x, y, z, w. */
  quaternion: Sim3["rotation"];
  /**
   * Heading of the front, seen from above, −π to π: 0 points away from the camera, π/2 to its left. For formats whose
   * cuboids rotate about the vertical only. "Above" is relative to the camera, so the camera must be level.
   */
  yawRad: number;
  /** Angle between the up directions of cuboid and camera, 0 to π; the yaw does not include it. */
  tiltRad: number;
  frame: CameraFrame;
};

/**
 * Converts the box around an object to a cuboid for annotation tools.
 *
 * @param box from {@link orientedBoundingBox}
 *
 * @example
 * const { center, size, yawRad } = toCuboid(orientedBoundingBox(mesh, result));
 * @throws {@link Sim3AlignError} for an invalid box, and `INVALID_OPTION` if the axes are not perpendicular
 */
export function toCuboid(
  box: Pick<OrientedBoundingBox, "sizeM" | "centerM" | "rotation">,
  options: CuboidOptions = {},
): Cuboid {
  const { frame = "ros", front = "z", up = "y" } = optionsOf(options, ["frame", "front", "up"]);
  const { sizeM, centerM, rotation } = record("box", box, "{ sizeM, centerM, rotation }");
  const sides = finiteNumbers("box.sizeM", sizeM, 3, "three finite numbers") as Vector3;
  for (const side of sides) if (side !== 0) positive("box.sizeM", side);
  const [length, height] = [axisOf("options.front", front), axisOf("options.up", up)];
  const isParallel = front.endsWith(up.slice(-1));
  oneOf("options.up", up, isParallel ? meshAxes.filter((axis) => !front.endsWith(axis.slice(-1))) : meshAxes);
  const left = cross(height, length);
  const boxFromCuboid = fromColumns(length, left, height);
  const cameraFromCuboid = product(rotationFromQuaternion("box.rotation", rotation), boxFromCuboid);
  const side = (axis: Vector3) => Math.abs(dot(axis, sides));
  const body: Matrix3 = product(turnTo("frame", "ros"), cameraFromCuboid);
  const [forward, upward] = [column(body, 0), column(body, 2)];
  const turn = turnTo("options.frame", frame);
  return {
    center: turned(turn, vector3("box.centerM", centerM)),
    size: [side(length), side(left), side(height)],
    quaternion: quaternionOf(product(turn, cameraFromCuboid)),
    yawRad: Math.atan2(forward[1], forward[0]),
    tiltRad: Math.atan2(Math.hypot(upward[0], upward[1]), upward[2]),
    frame,
  };
}

const meshAxes: readonly MeshAxis[] = ["x", "-x", "y", "-y", "z", "-z"];

function axisOf(argument: string, axis: MeshAxis): Vector3 {
  oneOf(argument, axis, meshAxes);
  const sign = axis.startsWith("-") ? -1 : 1;
  return ["x", "y", "z"].map((name) => (axis.endsWith(name) ? sign : 0)) as Vector3;
}
