/** The layout of SAM 3D Objects. */
import type { Sim3, Sim3Like } from "../sim3.js";
import { failure, finiteNumbers, flattened, oneOf, record, type Vector3, vector3 } from "../values.js";
import { turnTo } from "./frames.js";
import {
  type Matrix3,
  product,
  quaternionOf,
  rotationFromQuaternion,
  transposed,
  turned,
  wxyzFromXyzw,
  xyzwFromWxyz,
} from "./rotation.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** Numbers as a tensor's `tolist()` has them, with any number of leading dimensions of 1. */
export type Nested = number | ArrayLike<number> | readonly (readonly number[])[] | readonly (readonly number[])[][];

/** What SAM 3D Objects returns beside the mesh. */
export interface Sam3dLayout {
  /** One number, or three that are equal. */
  scale: Nested;
  /** A quaternion w, x, y, z, for row vectors: p′ = (p·S)·R + t. */
  rotation: Nested;
  /** In the unit of its point map, in PyTorch3D's camera frame. */
  translation: Nested;
}

/** Which of its outputs the vertices are of: the GLB, whose y is up, or the Gaussians and latents, whose z is. */
export type Sam3dVertices = "glb" | "z-up";

/** The rows that turn a vertex into the frame that the layout is about. */
const zUpFrom: Readonly<Record<Sam3dVertices, Matrix3>> = {
  glb: [1, 0, 0, 0, 0, -1, 0, 1, 0],
  "z-up": [1, 0, 0, 0, 1, 0, 0, 0, 1],
};

const zUp = (vertices: Sam3dVertices) => zUpFrom[oneOf("options.vertices", vertices, ["glb", "z-up"])];

/**
 * OpenCV camera from the vertices of SAM 3D Objects' GLB, from the layout that it returns beside it.
 *
 * The layout is about another frame than the GLB: the object's z is up there (a GLB vertex x, y, z is x, −z, y), the
 * camera is PyTorch3D's (x left, y up, z forward), and vectors are rows. Its translation is in the unit of the point
 * map that the model was given: metres, if that was metric.
 *
 * @param layout `scale`, `rotation` (w, x, y, z) and `translation`, as arrays, nested or not (`tensor.tolist()`)
 * @param options `vertices`: "z-up" for vertices of the Gaussians; "glb" by default
 *
 * @example
 * const initial = fromSam3d({ scale: [[0.4, 0.4, 0.4]], rotation: [[1, 0, 0, 0]], translation: [[0, 0, 2]] });
 * await aligner.align(input, { initial });
 * @throws {@link Sim3AlignError} for missing or wrong numbers; `INVALID_TRANSFORM` for a scale that differs by axis
 */
export function fromSam3d(layout: Sam3dLayout, { vertices = "glb" }: { vertices?: Sam3dVertices } = {}): Sim3 {
  const { scale, rotation, translation } = record("layout", layout, "{ scale, rotation, translation }");
  const q = xyzwFromWxyz(finiteNumbers("layout.rotation", rotation, 4, "a quaternion: four finite numbers, w first"));
  const camera = turnTo("frame", "pytorch3d");
  const fromZUp = transposed(rotationFromQuaternion("layout.rotation", q));
  return sim3Of({
    scale: uniformScale(scale),
    rotation: product(camera, product(fromZUp, zUp(vertices))),
    // The turn between the two camera frames is its own inverse.
    translation: turned(camera, vector3("layout.translation", translation)),
  });
}

function uniformScale(value: unknown): number {
  const argument = "layout.scale";
  const flat = flattened(value) ?? [value];
  const count = flat.length === 1 ? 1 : 3;
  const numbers = finiteNumbers(argument, flat, count, "one finite number, or three that are equal");
  const [x = 0] = numbers;
  if (x > 0 && numbers.every((number) => Math.abs(number - x) <= 1e-5 * x)) return x;
  const remedy = "A similarity has one scale: multiply the mesh by what differs between the axes.";
  throw failure("INVALID_TRANSFORM", argument, `[${numbers.join(", ")}]`, "equal numbers above 0", remedy);
}

/**
 * The inverse of {@link fromSam3d}: a transform as a layout of SAM 3D Objects.
 *
 * @param transform OpenCV camera from vertices, metres
 * @param options `vertices`: as for {@link fromSam3d}
 *
 * @example
 * const { scale, rotation, translation } = toSam3d(result);    // rotation: w, x, y, z
 * @throws {@link Sim3AlignError} for what is no similarity
 */
export function toSam3d(
  transform: Sim3Like,
  { vertices = "glb" }: { vertices?: Sam3dVertices } = {},
): { scale: Vector3; rotation: [w: number, x: number, y: number, z: number]; translation: Vector3 } {
  const { scale, rotation, translation } = similarityOf(transform);
  const camera = turnTo("frame", "pytorch3d");
  const fromZUp = product(product(camera, rotation), transposed(zUp(vertices)));
  return {
    scale: [scale, scale, scale],
    rotation: wxyzFromXyzw(quaternionOf(transposed(fromZUp))),
    translation: turned(camera, translation),
  };
}
