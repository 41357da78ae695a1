/** Poses in the format of the BOP benchmark. */
import type { Sim3, Sim3Like } from "../input/sim3.js";
import { finiteNumbers, optionsOf, positive, record, vector3, whole } from "../values/validation.js";
import { type Matrix3, rotationOf } from "./rotation.js";
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
