/** The parts that exports of scenes share: the objects, the camera, and the frame on the ground. */
import { invalidArgument } from "../values/error.js";
import { finite, flattened, positive, record, text, type Vector3, vector3 } from "../values/validation.js";
import { cross, dot, type Matrix3, meanOf, minus, norm, scaled, turned, unit } from "./rotation.js";
import type { Similarity } from "./similarity.js";

/** The objects of a call, each with a name. */
export function sceneObjects<T extends { name?: string | undefined }>(
  objects: readonly T[],
  unnamed: (index: number) => string,
): (T & { name: string })[] {
  const list = flattened(objects);
  if (list === null) {
    throw invalidArgument("objects", objects, "an array of { mesh, transform }", "Pass one of these per object.");
  }
  return list.map((object, i) => {
    const own = record(`objects[${i}]`, object, "{ mesh, transform }") as unknown as T;
    return { ...own, name: text(`objects[${i}].name`, own.name ?? unnamed(i)) };
  });
}

/** The camera of an exported scene: its intrinsics, and the size of its image, in pixels. */
export interface SceneCamera {
  fy: number;
  width: number;
  height: number;
  /** By default, that of square pixels. */
  fx?: number | undefined;
  /** By default, the centre of the image. */
  cx?: number | undefined;
  /** By default, the centre of the image. */
  cy?: number | undefined;
}

/** The camera of a call, and its vertical field of view. */
export function sceneCamera(camera: unknown): Record<keyof SceneCamera | "fovYRad", number> {
  const given = record("options.camera", camera, "{ fy, width, height }");
  const number = (name: string, byDefault?: number) => positive(`options.camera.${name}`, given[name] ?? byDefault);
  const [fy, width, height] = [number("fy"), number("width"), number("height")];
  const [cx, cy] = [given.cx ?? (width - 1) / 2, given.cy ?? (height - 1) / 2];
  return {
    ...{ fx: number("fx", fy), fy, cx: finite("options.camera.cx", cx), cy: finite("options.camera.cy", cy) },
    ...{ fovYRad: 2 * Math.atan(height / (2 * fy)), width, height },
  };
}

/** A direction of length 1. */
export function directionOf(argument: string, value: unknown): { direction: Vector3; length: number } {
  const given = vector3(argument, value);
  const length = positive(`the length of ${argument}`, norm(given));
  return { direction: scaled(given, 1 / length), length };
}

/**
 * The frame of a scene on a plane, from that of the OpenCV camera, metres. Its origin is the foot of the mean of the centres;
 * x is to the right of the camera, as far as the ground allows. Without a plane, up is that of the image, and the origin is
 * the camera.
 * @throws {@link Sim3AlignError} for an invalid plane
 */
export function sceneFromCamera(
  support: { normal: ArrayLike<number>; d: number } | null,
  centers: readonly Vector3[],
  upAxis: "y" | "z",
): Similarity {
  let [right, up, origin]: [Vector3, Vector3, Vector3] = [
    [1, 0, 0],
    [0, -1, 0],
    [0, 0, 0],
  ];
  if (support !== null) {
    record("options.support", support, "{ normal, d }");
    const plane = directionOf("options.support.normal", support.normal);
    const d = finite("options.support.d", support.d) / plane.length;
    up = plane.direction;
    // The camera's right stays right, unless it looks along the ground sideways.
    const along: Vector3 = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, -1];
    right = unit(minus(along, scaled(up, dot(along, up))));
    const center = meanOf(centers);
    origin = minus(center, scaled(up, dot(up, center) + d));
  }
  const back = cross(right, up);
  const rotation: Matrix3 = upAxis === "y" ? [...right, ...up, ...back] : [...right, ...scaled(back, -1), ...up];
  return { scale: 1, rotation, translation: scaled(turned(rotation, origin), -1) };
}
