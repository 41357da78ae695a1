/** Pose files: `gt.json` of a case, an annotation, or a saved result. */

import type { Sim3 } from "../input/sim3.js";
import { failure } from "../values/error.js";
import { isNumber, type JsonFile, numbersIn, parsedJson, shown } from "../values/json.js";
import { isKind, isRecord } from "../values/kinds.js";
import { fromBop } from "./bop.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** A known pose, and the symmetry declared in its file. */
export interface KnownPose {
  /** OpenCV camera from mesh, metres. */
  transform: Sim3;
  /** For the option `symmetry` of `evaluate`. */
  symmetry: "none" | "auto";
}

/** Names of a 4 × 4 matrix, camera from mesh, in metres. */
const matrixNames = [
  ...["matrix", "cameraFromMesh", "camera_from_mesh", "cam_from_obj", "cam_T_obj", "ob_in_cam", "object_pose"],
  ...["transform", "transformation", "pose", "T"],
];

/** Whether an object is a pose by its names, rather than poses by the names of cases. */
export const isPose = (json: Record<string, unknown>): boolean =>
  ["scale", "available", "cam_R_m2c", ...matrixNames].some((name) => name in json && !isRecord(json[name]));

/**
 * Reads a pose file: `{ scale, rotation, translation }` with the rotation as 3×3 numbers, row-major, or as a quaternion
 * x, y, z, w; a 4 × 4 matrix, bare or as `matrix`: rows of numbers, also as text, or 16 numbers, column-major unless they are the
 * rows of a rigid transform; or an entry of BOP's `scene_gt.json`.
 * @returns `null` if the file declares that no pose is known (`available` is `false`)
 */
export function parsePoseFile(argument: string, content: JsonFile): KnownPose | null {
  const json = poseJson(argument, content);
  if (isRecord(json) && json.available === false) return null;
  return { transform: transformIn(argument, json), symmetry: symmetryOf(isRecord(json) ? json.symmetry : undefined) };
}

/** The JSON of a pose file, or the rows of the matrix in its text. */
export function poseJson(argument: string, content: JsonFile): unknown {
  const rows = matrixInText(content);
  return rows ?? parsedJson(argument, content);
}

/** 4 × 4 or 3 × 4 numbers in lines, as NumPy's `savetxt` and `print` write them; `undefined` for anything else. */
function matrixInText(content: JsonFile): number[][] | undefined {
  const isText = typeof content === "string";
  if ((!isText && !isKind<Uint8Array>(content, "Uint8Array")) || content.length > MAX_TEXT) return undefined;
  const text = isText ? content : new TextDecoder().decode(content);
  const words = text.replace(/^\s*#.*$/gm, "").match(/[^\s,;[\]()]+/g) ?? [];
  const numbers = words.map(Number);
  const isMatrix = (numbers.length === 16 || numbers.length === 12) && numbers.every(isNumber);
  // Sixteen numbers in one line of JSON are by columns.
  if (!isMatrix || /^\s*\[[^[\]]*\]\s*$/.test(text)) return undefined;
  return rowsOf(numbers);
}

/** Longest text of a matrix. */
const MAX_TEXT = 4096;

const rowsOf = (numbers: readonly number[]) =>
  [0, 4, 8, 12].map((start) => (start < numbers.length ? numbers.slice(start, start + 4) : [0, 0, 0, 1]));

/**
 * The 16 numbers of a matrix, column-major; `null` for anything else. Nested numbers are rows. Of 16 numbers in a row, those of
 * a rigid transform by rows end with 0, 0, 0, 1, and those by columns have these at every fourth place.
 */
export function columnMajor(value: unknown): number[] | null {
  const numbers = numbersIn(value, 16) ?? numbersIn(value, 12);
  if (numbers === null || !Array.isArray(value)) return null;
  const isBottom = (row: readonly unknown[]) => [0, 0, 0, 1].every((x, k) => row[k] === x);
  const isNested = Array.isArray(value[0]);
  const everyFourth = [3, 7, 11, 15].map((i) => numbers[i]);
  const isByRows = numbers.length === 12 || isNested || (isBottom(numbers.slice(12)) && !isBottom(everyFourth));
  if (!isByRows) return numbers;
  const rows = rowsOf(numbers);
  return [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column] as number));
}

function transformIn(argument: string, json: unknown): Sim3 {
  const remedy = "Write { scale, rotation, translation } or { matrix }; x_cam = scale · R · p_mesh + translation.";
  // BOP has a list of objects for each image.
  if (Array.isArray(json) && json.length === 1 && isRecord(json[0])) return transformIn(argument, json[0]);
  if (!isRecord(json)) {
    const matrix = columnMajor(json);
    if (matrix !== null) return sim3Of(similarityOf(matrix, argument));
    const expected = "{ scale, rotation, translation }, or the rows of a 4 × 4 matrix";
    throw failure("INVALID_TRANSFORM", argument, shown(json), expected, remedy);
  }
  if ("cam_R_m2c" in json) return fromBop(json as unknown as Parameters<typeof fromBop>[0]);
  const invalid = (name: string, expected: string) =>
    failure("INVALID_TRANSFORM", `${argument}.${name}`, shown(json[name]), expected, remedy);
  const name = "scale" in json ? "matrix" : (matrixNames.find((each) => each in json) ?? "matrix");
  if (name in json) {
    const matrix = columnMajor(json[name]);
    if (matrix === null) throw invalid(name, "4 rows of 4 numbers, or 16 numbers, column-major");
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
