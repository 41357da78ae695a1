/** Masks in CVAT's format: run lengths along the rows of the bounding box of the mask. */

import { filledRuns } from "../input/coco-rle.js";
import { plainArgument } from "../values/border.js";
import { describe, failure } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { type PixelArray, sizeOf } from "../values/pixels.js";
import { flattened, whole } from "../values/validation.js";

/** A `<mask>` element of CVAT's XML ("CVAT for images"); attributes may be strings, as returned by an XML parser. */
export interface CvatMaskElement {
  /** Run lengths, comma-separated, beginning with background. */
  rle: string;
  left: number | string;
  top: number | string;
  width: number | string;
  height: number | string;
}

/** Decodes the `points` of a mask shape, or a mask element. */
export function decodedCvat(rle: unknown, image: unknown): PixelArray<Uint8Array> {
  const { width, height } = sizeOf("image", image);
  const { runs, left, top, boxWidth, boxHeight } = isRecord(rle)
    ? fromElement(plainArgument("rle", rle))
    : fromPoints(rle);
  if (left + boxWidth > width || top + boxHeight > height) {
    const found = `a box of ${boxWidth} × ${boxHeight} at ${left}, ${top} in ${width} × ${height} pixels`;
    throw failure("SIZE_MISMATCH", "rle", found, "a box within the image", "Pass the size of the annotated image.");
  }
  const box = filledRuns("rle", runs, boxWidth * boxHeight);
  const data = new Uint8Array(width * height);
  for (let v = 0; v < boxHeight; v++) {
    data.set(box.subarray(v * boxWidth, (v + 1) * boxWidth), (top + v) * width + left);
  }
  return { data, width, height };
}

interface BoxRuns {
  runs: readonly unknown[];
  left: number;
  top: number;
  boxWidth: number;
  boxHeight: number;
}

function fromPoints(points: unknown): BoxRuns {
  const numbers = flattened(points);
  if (numbers === null) {
    const expected = "[run, run, …, left, top, right, bottom], or { rle, left, top, width, height }";
    throw failure("INVALID_ARGUMENT", "rle", describe(points), expected, "Pass the points of a mask shape.");
  }
  if (numbers.length < 5) {
    const remedy = "Pass the points of a shape of type mask.";
    const expected = "run lengths and the four numbers of the box";
    throw failure("WRONG_LENGTH", "rle", `${numbers.length} numbers`, expected, remedy);
  }
  const [left, top, right, bottom] = numbers.splice(-4);
  const [x, y] = [whole("rle.left", left, 0), whole("rle.top", top, 0)];
  // Right and bottom are inclusive.
  const boxWidth = whole("rle.right", right, x) - x + 1;
  return { runs: numbers, left: x, top: y, boxWidth, boxHeight: whole("rle.bottom", bottom, y) - y + 1 };
}

function fromElement({ rle, left, top, width, height }: Record<string, unknown>): BoxRuns {
  if (typeof rle !== "string") {
    const remedy = "Pass the attributes of a mask element.";
    throw failure("INVALID_ARGUMENT", "rle.rle", describe(rle), "a string of comma-separated run lengths", remedy);
  }
  const number = (name: string, value: unknown, least: number) =>
    whole(`rle.${name}`, typeof value === "string" && value.trim() !== "" ? Number(value) : value, least);
  return {
    runs: rle.split(",").map(Number),
    left: number("left", left, 0),
    top: number("top", top, 0),
    boxWidth: number("width", width, 1),
    boxHeight: number("height", height, 1),
  };
}
