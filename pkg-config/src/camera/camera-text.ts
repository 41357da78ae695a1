/** Camera files that are no JSON: numbers, named values, COLMAP's cameras.txt and OpenCV's YAML. */
import { isNumber } from "../values/json.js";

const numeral = "[-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:e[-+]?\\d+)?";

/**
 * The camera in a text, as the JSON with the same meaning: the numbers of a matrix, or an object of named values.
 * `undefined` if it is another text.
 */
export function cameraText(text: string): number[] | Record<string, unknown> | undefined {
  const content = text.replace(/^\ufeff/, "").replace(/^%YAML.*$|#.*$|^---.*$/gm, "");
  return colmap(content) ?? yaml(content) ?? named(content) ?? numbersOf(content);
}

/** Numbers with spaces, commas, semicolons or brackets between them, also as NumPy prints them. */
function numbersOf(text: string): number[] | undefined {
  if (text.replace(new RegExp(`${numeral}|\\barray\\b|[\\s,;()[\\]]`, "gi"), "") !== "") return undefined;
  const numbers = (text.match(new RegExp(numeral, "gi")) ?? []).map(Number);
  return numbers.length > 0 && numbers.every(isNumber) ? numbers : undefined;
}

/** `CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS` of one camera; the centre of COLMAP's first pixel is at 0.5. */
function colmap(text: string): Record<string, unknown> | undefined {
  const lines = text.split(/\r?\n/).filter((line) => line.trim() !== "");
  const [, model = "", ...rest] = lines[0]?.trim().split(/\s+/) ?? [];
  const [width, height, ...parameters] = rest.map(Number);
  const single = /^(SIMPLE_PINHOLE|SIMPLE_RADIAL|RADIAL)$/.test(model);
  if (lines.length !== 1 || !(single || /^(PINHOLE|OPENCV|FULL_OPENCV)$/.test(model))) return undefined;
  const [fx, fy, cx, cy, ...D] = single ? [parameters[0], ...parameters] : parameters;
  return { width, height, fx, fy, cx: Number(cx) - 0.5, cy: Number(cy) - 0.5, D };
}

/** The `data` of OpenCV's and ROS' `camera_matrix`, with the image size. */
function yaml(text: string): Record<string, unknown> | undefined {
  const matrix = /\b(camera_matrix|K)\s*:[^[]*\[([^\]]*)\]/.exec(text)?.[2];
  if (matrix === undefined) return undefined;
  const side = (name: string) => {
    const value = new RegExp(`\\b(?:image_)?${name}\\s*:\\s*(\\d+)`).exec(text)?.[1];
    return value === undefined ? undefined : Number(value);
  };
  const distortion = /\b(?:distortion_coefficients|D)\s*:[^[]*\[([^\]]*)\]/.exec(text)?.[1] ?? "";
  return { K: numbersOf(matrix), width: side("width"), height: side("height"), D: numbersOf(distortion) ?? [] };
}

/** `fx: 600` or `fx = 600`, one or several in a line. */
function named(text: string): Record<string, unknown> | undefined {
  const pair = new RegExp(`["']?([a-z_]\\w*)["']?\\s*[:=]\\s*(${numeral})`, "gi");
  const pairs = [...text.matchAll(pair)].map(([, name = "", value]) => [name, Number(value)] as const);
  if (pairs.length === 0 || text.replace(pair, "").replace(/[\s,;{}]/g, "") !== "") return undefined;
  return Object.fromEntries(pairs);
}
