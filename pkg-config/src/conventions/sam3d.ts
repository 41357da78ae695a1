/** Layouts of SAM 3D Objects. */

import type { Sim3, Sim3Like } from "../input/sim3.js";
import { failure } from "../values/error.js";
import { finiteNumbers, flattened, oneOf, optionsOf, type Quaternion, record, vector3 } from "../values/validation.js";
import { turnTo } from "./frames.js";
import { type Matrix3, product, quaternionOf, rotationFromQuaternion, transposed, turned, wFirst } from "./rotation.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** Numbers from a tensor's `tolist()`, with any number of leading dimensions of 1. */
export type Nested = number | ArrayLike<number> | readonly (readonly number[])[] | readonly (readonly number[])[][];

/** The layout that SAM 3D Objects returns with the mesh. */
export interface Sam3dLayout {
  /** One number, or three that are equal. */
  scale: Nested;
  /** A quaternion w, x, y, z, for row vectors: p′ = (p·S)·R + t. */
  rotation: Nested;
  /** In PyTorch3D's camera frame, in the unit of the point map. */
  translation: Nested;
}

/** The output that the vertices come from: the GLB (y up), or the Gaussians and latents (z up). */
export type Sam3dVertices = "glb" | "z-up";

/** Rotations (row-major) from the vertices to the frame of the layout. */
const zUpFrom: Readonly<Record<Sam3dVertices, Matrix3>> = {
  glb: [1, 0, 0, 0, 0, -1, 0, 1, 0],
  "z-up": [1, 0, 0, 0, 1, 0, 0, 0, 1],
};

const zUp = (vertices: Sam3dVertices) => zUpFrom[oneOf("options.vertices", vertices, ["glb", "z-up"])];

/**
 * Converts a layout of SAM 3D Objects to a transform from the vertices of its GLB to the OpenCV camera frame.
 *
 * The layout uses other frames than the GLB: the z axis of the object is up (a GLB vertex x, y, z is x, −z, y), the
 * camera frame is PyTorch3D's (x left, y up, z forward), and vectors are rows. The translation is in the unit of the
 * point map passed to the model: metres for a metric point map.
 *
 * @param layout `scale`, `rotation` (w, x, y, z) and `translation`, as arrays, nested or flat (`tensor.tolist()`)
 * @param options `vertices`: "z-up" for vertices of the Gaussians; "glb" by default
 *
 * @example
 * const initial = fromSam3d({ scale: [[0.4, 0.4, 0.4]], rotation: [[1, 0, 0, 0]], translation: [[0, 0, 2]] });
 * await aligner.align(input, { initial });
 * @throws {@link Sim3AlignError} for missing or invalid numbers; `INVALID_TRANSFORM` for a non-uniform scale
 */
export function fromSam3d(layout: Sam3dLayout, options: { vertices?: Sam3dVertices } = {}): Sim3 {
  const { vertices = "glb" } = optionsOf(options, ["vertices"]);
  const { scale, rotation, translation } = record("layout", layout, "{ scale, rotation, translation }");
  const [w, x, y, z] = quaternionIn(rotation);
  const camera = turnTo("frame", "pytorch3d");
  const fromZUp = transposed(rotationFromQuaternion("layout.rotation", [x, y, z, w]));
  return sim3Of({
    scale: uniformScale(scale),
    rotation: product(camera, product(fromZUp, zUp(vertices))),
    // The rotation between the two camera frames is its own inverse.
    translation: turned(camera, vector3("layout.translation", translation)),
  });
}

function quaternionIn(rotation: unknown): Quaternion {
  const argument = "layout.rotation";
  const expected = "a quaternion: four finite numbers, w first";
  if (flattened(rotation)?.length !== 9) return finiteNumbers(argument, rotation, 4, expected) as Quaternion;
  // Whoever has a matrix has mostly a pose of another program.
  const remedy =
    "SAM 3D Objects writes the quaternion w, x, y, z. A pose in OpenCV's frame belongs in initial.json, without --sam3d.";
  throw failure("WRONG_LENGTH", argument, "9 numbers", expected, remedy);
}

function uniformScale(value: unknown): number {
  const argument = "layout.scale";
  const flat = flattened(value) ?? [value];
  const count = flat.length === 1 ? 1 : 3;
  const numbers = finiteNumbers(argument, flat, count, "one finite number, or three that are equal");
  const [x = 0] = numbers;
  if (x > 0 && numbers.every((number) => Math.abs(number - x) <= 1e-5 * x)) return x;
  const remedy = "A similarity has a uniform scale. Apply the non-uniform part to the mesh.";
  throw failure("INVALID_TRANSFORM", argument, `[${numbers.join(", ")}]`, "equal numbers above 0", remedy);
}

/**
 * The inverse of {@link fromSam3d}: converts a transform to a layout of SAM 3D Objects.
 *
 * @param transform OpenCV camera from vertices, metres
 * @param options `vertices`: as for {@link fromSam3d}
 *
 * @example
 * const { scale, rotation, translation } = toSam3d(result);    // rotation: w, x, y, z
 * @throws {@link Sim3AlignError} if the transform is not a similarity
 */
export function toSam3d(
  transform: Sim3Like,
  options: { vertices?: Sam3dVertices } = {},
): {
  scale: Sim3["translation"];
  rotation: [w: number, x: number, y: number, z: number];
  translation: Sim3["translation"];
} {
  const { vertices = "glb" } = optionsOf(options, ["vertices"]);
  const { scale, rotation, translation } = similarityOf(transform);
  const camera = turnTo("frame", "pytorch3d");
  const fromZUp = product(product(camera, rotation), transposed(zUp(vertices)));
  return {
    scale: [scale, scale, scale],
    rotation: wFirst(quaternionOf(transposed(fromZUp))),
    translation: turned(camera, translation),
  };
}
