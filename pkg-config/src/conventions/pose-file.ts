/** Pose files: `gt.json` of a case, an annotation, or a saved result. */

import type { Sim3 } from "../input/sim3.js";
import { failure } from "../values/error.js";
import { isNumber, type JsonFile, numbersIn, parsedJson, shown } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { fromBop } from "./bop.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** A known pose, and the symmetry declared in its file. */
export interface KnownPose {
  /** OpenCV camera from mesh, metres. */
  transform: Sim3;
  /** For the option `symmetry` of `evaluate`. */
  symmetry: "none" | "auto";
}

/**
 * Reads a pose file: `{ scale, rotation, translation }` with the rotation as 3×3 numbers, row-major, or as a quaternion
 * x, y, z, w; `{ matrix }` or a bare array of 16 numbers, column-major; or an entry of BOP's `scene_gt.json`.
 * @returns `null` if the file declares that no pose is known (`available` is `false`)
 */
export function parsePoseFile(argument: string, content: JsonFile): KnownPose | null {
  const json = parsedJson(argument, content);
  if (isRecord(json) && json.available === false) return null;
  const transform = transformIn(argument, Array.isArray(json) ? { matrix: json } : json);
  return { transform, symmetry: symmetryOf(isRecord(json) ? json.symmetry : undefined) };
}

function transformIn(argument: string, json: unknown): Sim3 {
  const remedy = "Write { scale, rotation, translation } or { matrix }; x_cam = scale · R · p_mesh + translation.";
  if (!isRecord(json)) {
    const expected = "{ scale, rotation, translation }";
    throw failure("INVALID_TRANSFORM", argument, "JSON that is not an object", expected, remedy);
  }
  if ("cam_R_m2c" in json) return fromBop(json as unknown as Parameters<typeof fromBop>[0]);
  const invalid = (name: string, expected: string) =>
    failure("INVALID_TRANSFORM", `${argument}.${name}`, shown(json[name]), expected, remedy);
  if ("matrix" in json) {
    const matrix = numbersIn(json.matrix, 16);
    if (matrix === null) throw invalid("matrix", "16 numbers, column-major");
    return sim3Of(similarityOf(matrix, argument));
  }
  const { scale, rotation, translation } = json;
  if (!isNumber(scale)) throw invalid("scale", "a number");
  const place = numbersIn(translation, 3);
  if (place === null) throw invalid("translation", "3 numbers, in metres");
  const turn = numbersIn(rotation, 9) ?? numbersIn(rotation, 4);
  if (turn === null) throw invalid("rotation", "3 × 3 numbers, row-major, or a quaternion x, y, z, w");
  return sim3Of(similarityOf({ scale, rotation: turn, translation: place }, argument));
}

/** The symmetry for a description in a data set: "discrete", "continuous about z", … */
function symmetryOf(words: unknown): KnownPose["symmetry"] {
  const text = typeof words === "string" ? words.trim().toLowerCase() : "";
  return text.startsWith("discrete") || text.startsWith("continuous") ? "auto" : "none";
}
