/** Cuboids as annotation tools have them. */

import { finiteNumbers, oneOf, positive, type Quaternion, record, type Vector3, vector3 } from "../values.js";
import { type CameraFrame, turnTo } from "./frames.js";
import type { ObjectBox } from "./object-box.js";
import {
  column,
  fromColumns,
  type Matrix3,
  product,
  quaternionOf,
  rotationFromQuaternion,
  turned,
} from "./rotation.js";

/** A direction along one of a mesh's axes. */
export type MeshAxis = "x" | "-x" | "y" | "-y" | "z" | "-z";

/** What {@link toCuboid} can be told. */
export interface CuboidOptions {
  /** The frame of centre and quaternion: "ros" (x forward, y left, z up) by default. */
  frame?: CameraFrame | undefined;
  /** Which of the box's axes points to the object's front: "z" by default, as in glTF. */
  front?: MeshAxis | undefined;
  /** Which of them points up: "y" by default, as in glTF. */
  up?: MeshAxis | undefined;
}

/** A cuboid: x along its length to the object's front, y along its width to the left, z along its height. */
export interface Cuboid {
  /** In metres. */
  center: Vector3;
  /** Length, width, height: the sides along the cuboid's own x, y, z, in metres. */
  size: Vector3;
  /** Frame from cuboid: x, y, z, w. */
  quaternion: Quaternion;
  /**
   * Where the front points, seen from above: 0 is away from the camera, π/2 to its left, −π to π, for formats whose
   * cuboids turn about the vertical only. "Above" is the camera's: right where it is level.
   */
  yawRad: number;
  /** How far the cuboid's up is from the camera's, 0 to π: what a yaw alone leaves out. */
  tiltRad: number;
  frame: CameraFrame;
}

/**
 * A cuboid for annotation tools, from the box around an object.
 *
 * @param box from {@link objectDimensions}
 *
 * @example
 * const { center, size, yawRad } = toCuboid(objectDimensions(mesh, result));
 * @throws {@link Sim3AlignError} for what is no box, and `INVALID_OPTION` for axes that are not two different ones
 */
export function toCuboid(
  box: Pick<ObjectBox, "sizeM" | "centerM" | "rotation">,
  { frame = "ros", front = "z", up = "y" }: CuboidOptions = {},
): Cuboid {
  const { sizeM, centerM, rotation } = record("box", box, "{ sizeM, centerM, rotation }");
  const sides = finiteNumbers("box.sizeM", sizeM, 3, "three finite numbers") as Vector3;
  for (const side of sides) if (side !== 0) positive("box.sizeM", side);
  const [length, height] = [axisOf("options.front", front), axisOf("options.up", up)];
  oneOf(
    "options.up",
    up,
    front.endsWith(up.slice(-1)) ? meshAxes.filter((axis) => !front.endsWith(axis.slice(-1))) : meshAxes,
  );
  const [fx, fy, fz] = length;
  const [ux, uy, uz] = height;
  const left: Vector3 = [uy * fz - uz * fy, uz * fx - ux * fz, ux * fy - uy * fx];
  const boxFromCuboid = fromColumns(length, left, height);
  const cameraFromCuboid = product(rotationFromQuaternion("box.rotation", rotation), boxFromCuboid);
  const side = (axis: Vector3) => Math.abs(axis[0] * sides[0] + axis[1] * sides[1] + axis[2] * sides[2]);
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
