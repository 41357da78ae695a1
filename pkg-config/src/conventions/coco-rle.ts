/** COCO's run lengths: down the columns, beginning with background. */
import { describe } from "../error.js";
import type { CocoRle, PixelArray } from "../input/types.js";
import { failure, finiteNumbers, record } from "./numbers.js";
import { type MaskPixels, maskKinds, pixelsOf, sizeOf } from "./pixels.js";
import { filledRuns } from "./runs.js";

/**
 * A mask as COCO's run-length encoding, as pycocotools writes it.
 *
 * @param mask `{ data, width, height }`, row by row; non-zero is the object
 * @param options `compressed`: whether `counts` is a string, as in COCO's result files (the default), or a list of run
 * lengths, as in its annotations of crowds
 * @returns `size` is [height, width]
 *
 * @example
 * toCocoRle({ data: Uint8Array.of(0, 1, 1, 1), width: 2, height: 2 }, { compressed: false }).counts;    // [1, 3]
 * @throws {@link Sim3AlignError} for a mask of the wrong kind or length
 */
export function toCocoRle(mask: PixelArray<MaskPixels>, options?: { compressed?: true }): CocoRle & { counts: string };
export function toCocoRle(
  mask: PixelArray<MaskPixels>,
  options: { compressed: false },
): CocoRle & { counts: readonly number[] };
export function toCocoRle(mask: PixelArray<MaskPixels>, { compressed = true }: { compressed?: boolean } = {}): CocoRle {
  const { data, width, height } = pixelsOf<MaskPixels>("mask", mask, maskKinds);
  const counts: number[] = [];
  let run = 0;
  let isObject = false;
  for (let place = 0; place < data.length; place++) {
    const pixel = data[(place % height) * width + Math.floor(place / height)] !== 0;
    if (pixel !== isObject) {
      counts.push(run);
      run = 0;
      isObject = pixel;
    }
    run += 1;
  }
  counts.push(run);
  return { size: [height, width], counts: compressed ? compress(counts) : counts };
}

/**
 * The mask of a run-length encoding of COCO's, compressed or not.
 *
 * `align` takes these as its `mask` as they are; this is for callers who want the pixels.
 * @returns 1 is the object
 *
 * @example
 * fromCocoRle({ size: [2, 2], counts: [1, 3] }).data;    // Uint8Array [0, 1, 1, 1]
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` where the runs are not those of that many pixels
 */
export function fromCocoRle(rle: CocoRle): PixelArray<Uint8Array> {
  const { size, counts } = record("rle", rle, "{ size: [height, width], counts }");
  const [height, width] = finiteNumbers("rle.size", size, 2, "[height, width]") as [number, number];
  sizeOf("rle.size", { width, height });
  const isList = Array.isArray(counts) || ArrayBuffer.isView(counts);
  if (!isList && typeof counts !== "string") {
    const remedy = "Polygons have to be drawn first, by pycocotools' annToMask.";
    throw failure("INVALID_ARGUMENT", "rle.counts", describe(counts), "a string, or a list of run lengths", remedy);
  }
  const runs = typeof counts === "string" ? decompressed(counts) : Array.from(counts as ArrayLike<number>);
  const columns = filledRuns("rle.counts", runs, width * height);
  const data = new Uint8Array(columns.length);
  for (let place = 0; place < data.length; place++) {
    data[(place % height) * width + Math.floor(place / height)] = columns[place] ?? 0;
  }
  return { data, width, height };
}

// Five bits a letter, the lowest first, with a sixth that says whether more follow, from "0" on. From the fourth run
// on, the difference to the run before the last is written.
const firstLetter = 48;

function compress(counts: readonly number[]): string {
  let text = "";
  counts.forEach((count, i) => {
    let rest = count - (i > 2 ? (counts[i - 2] ?? 0) : 0);
    for (let isLast = false; !isLast; ) {
      const bits = ((rest % 32) + 32) % 32;
      rest = (rest - bits) / 32;
      isLast = rest === (bits < 16 ? 0 : -1);
      text += String.fromCharCode(firstLetter + bits + (isLast ? 0 : 32));
    }
  });
  return text;
}

function decompressed(text: string): number[] {
  const broken = (found: string) => {
    const remedy = "Pass counts as pycocotools writes them, decoded as ASCII.";
    return failure("CORRUPT_FILE", "rle.counts", found, "a string of COCO's run lengths", remedy);
  };
  const counts: number[] = [];
  let value = 0;
  let factor = 1;
  for (const letter of text) {
    const six = (letter.codePointAt(0) ?? 0) - firstLetter;
    if (six < 0 || six > 63) throw broken(`the letter ${JSON.stringify(letter)}`);
    if (factor > 2 ** 30) throw broken("a number of more than 35 bits");
    value += (six & 31) * factor;
    factor *= 32;
    if (six >= 32) continue;
    if (six >= 16) value -= factor;
    counts.push(value + (counts.length > 2 ? (counts[counts.length - 2] ?? 0) : 0));
    value = 0;
    factor = 1;
  }
  if (factor !== 1) throw broken("an unfinished number at the end");
  return counts;
}
