/** Poses and symmetries in the format of the BOP benchmark. */
import type { Sim3, Sim3Like } from "../input/sim3.js";
import type { SymmetryAxis } from "../types/argument-types.js";
import type { MeshArrays } from "../types/inputs.js";
import { failure, invalidArgument } from "../values/error.js";
import { finiteNumbers, optionsOf, positive, record, type Vector3, vector3, whole } from "../values/validation.js";
import { meshOf } from "./mesh.js";
import { surfaceMoments } from "./principal-axes.js";
import {
  identity,
  type Matrix3,
  minus,
  norm,
  product,
  rotationOf,
  rotationOfUnit,
  scaled,
  turned,
  unit,
} from "./rotation.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** One object of BOP's `scene_gt.json`: camera from model, OpenCV camera frame, models in millimetres. */
export type BopPose = {
  /** The rotation: nine numbers, row-major. */
  cam_R_m2c: readonly number[];
  /** The translation, in millimetres. */
  cam_t_m2c: readonly number[];
  /** The id of the model. */
  obj_id?: number;
};

/**
 * Converts a pose for BOP's `scene_gt.json`. BOP's models are in millimetres and its poses have no scale, so the model
 * must be written at its real size: the vertices of the mesh times `1000 · scale`.
 *
 * @param transform OpenCV camera from mesh, metres
 * @param options `objId`: the id of the model, at least 1
 * @returns the entry for `scene_gt.json`, and the scale (metres per mesh unit), which is not part of BOP's format
 *
 * @example
 * const { entry, scale } = toBop(result, { objId: 3 });
 * const sceneGt = { 0: [entry] };
 * const modelMm = mesh.positions.map((x) => 1000 * scale * x);
 * @throws {@link Sim3AlignError} if the transform is not a similarity
 */
export function toBop(transform: Sim3Like, options: { objId?: number } = {}): { entry: BopPose; scale: number } {
  const { objId } = optionsOf(options, ["objId"]);
  const { scale, rotation, translation } = similarityOf(transform);
  const entry = { cam_R_m2c: [...rotation], cam_t_m2c: translation.map((metres) => 1000 * metres) };
  return { entry: objId === undefined ? entry : { ...entry, obj_id: whole("options.objId", objId, 0) }, scale };
}

/**
 * Converts an entry of BOP's `scene_gt.json` to a transform.
 *
 * @param entry `cam_R_m2c` (nine numbers, row-major) and `cam_t_m2c` (millimetres)
 * @param options `scale`: metres per mesh unit; by default 0.001, for a mesh in BOP's millimetres
 * @returns OpenCV camera from mesh, metres
 *
 * @example
 * const truth = fromBop(sceneGt["0"][0]);
 * await aligner.evaluate(input, result, { truth });
 * @throws {@link Sim3AlignError} for missing or invalid numbers
 */
export function fromBop(entry: BopPose, options: { scale?: number } = {}): Sim3 {
  const { scale = 0.001 } = optionsOf(options, ["scale"]);
  const { cam_R_m2c, cam_t_m2c } = record("entry", entry, "an entry of scene_gt.json");
  const nine = finiteNumbers("entry.cam_R_m2c", cam_R_m2c, 9, "nine finite numbers, row-major");
  const [x, y, z] = vector3("entry.cam_t_m2c", cam_t_m2c);
  return sim3Of({
    scale: positive("options.scale", scale),
    rotation: rotationOf("entry.cam_R_m2c", nine as unknown as Matrix3),
    translation: [x / 1000, y / 1000, z / 1000],
  });
}

/** The symmetries of one object of BOP's `models_info.json`, in millimetres. */
export type BopSymmetries = {
  /** The rotations other than the identity: 4×4 matrices, row-major. */
  symmetries_discrete?: number[][];
  /** The axes of revolution, each with a point on it. */
  symmetries_continuous?: { axis: Vector3; offset: Vector3 }[];
};

/** Rotations of the largest finite group: those of an icosahedron, or of a prism with half as many sides. */
const maxRotations = 720;
/** Entries of matrices that differ by less are of one rotation. */
const sameRotation = 1e-3;

/**
 * Converts the symmetry of a result for BOP's `models_info.json`, by which its toolkit counts poses as one. As in {@link toBop},
 * the model has the vertices of the mesh times `1000 · scale`.
 *
 * @param symmetry `symmetry` of a result of `align`, `alignScene` or `alignViews`
 * @param mesh the mesh that was aligned, as `readMesh` returns it: the axes pass through the centroid of its surface
 * @param options `scale`: metres per mesh unit; by default 0.001, for a mesh in BOP's millimetres
 * @returns the properties of the object in `models_info.json`; none without a symmetry
 *
 * @example
 * const info = { 1: bopSymmetries(result.symmetry, mesh, { scale: result.scale }) };
 * @throws {@link Sim3AlignError} for axes that are none, or generate no finite group
 */
export function bopSymmetries(
  symmetry: readonly SymmetryAxis[],
  mesh: MeshArrays,
  options: { scale?: number } = {},
): BopSymmetries {
  const { scale = 0.001 } = optionsOf(options, ["scale"]);
  const millimetres = 1000 * positive("options.scale", scale);
  const offset = scaled(surfaceMoments(meshOf("mesh", mesh)).centroid, millimetres);
  const remedy = "Pass the symmetry of a result.";
  if (!Array.isArray(symmetry)) throw invalidArgument("symmetry", symmetry, "an array of axes", remedy);
  const axes = symmetry.map((each: unknown, k) => {
    const { axis, fold } = record(`symmetry[${k}]`, each, "an axis { axis, fold }");
    return {
      axis: unitAxis(`symmetry[${k}].axis`, axis),
      fold: fold === undefined ? fold : whole(`symmetry[${k}].fold`, fold, 1),
    };
  });

  const turns = axes.filter(({ fold }) => fold !== undefined && fold > 1);
  const rotations = group(turns.map(({ axis, fold }) => rotationAbout(axis, (2 * Math.PI) / (fold ?? 1))));
  const discrete = rotations.slice(1).map((m) => {
    const [x, y, z] = minus(offset, turned(m, offset));
    return [...m.slice(0, 3), x, ...m.slice(3, 6), y, ...m.slice(6), z, 0, 0, 0, 1];
  });
  const continuous = axes.filter(({ fold }) => fold === undefined).map(({ axis }) => ({ axis, offset }));

  return {
    ...(discrete.length > 0 && { symmetries_discrete: discrete }),
    ...(continuous.length > 0 && { symmetries_continuous: continuous }),
  };
}

function unitAxis(argument: string, axis: unknown): Vector3 {
  const direction = vector3(argument, axis);
  if (norm(direction) > 0) return unit(direction);
  throw failure("INVALID_OPTION", argument, "a vector of length 0", "a direction", "Pass an axis of the result.");
}

const rotationAbout = (axis: Vector3, angle: number): Matrix3 =>
  rotationOfUnit([...scaled(axis, Math.sin(angle / 2)), Math.cos(angle / 2)]);

/** All products of rotations, the identity first. */
function group(generators: readonly Matrix3[]): Matrix3[] {
  const found: Matrix3[] = [identity];
  const isKnown = (m: Matrix3) =>
    found.some((other) => other.every((entry, i) => Math.abs(entry - (m[i] ?? 0)) < sameRotation));

  for (let next = 0; next < found.length; next++) {
    for (const generator of generators) {
      const m = product(found[next] ?? identity, generator);
      if (!isKnown(m)) found.push(m);
    }
    if (found.length > maxRotations) {
      const expected = "the axes of a finite group";
      throw failure(
        "INVALID_OPTION",
        "symmetry",
        `more than ${maxRotations} rotations`,
        expected,
        "Pass those of a result.",
      );
    }
  }
  return found;
}
