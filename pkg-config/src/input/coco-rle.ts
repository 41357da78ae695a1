/** COCO's run-length encoding of masks: column-major runs, starting with background. */

import type { CocoRle } from "../types/inputs.js";
import { describe, failure } from "../values/error.js";
import { type ImageSize, MAX_PIXELS, type MaskPixels, maskKinds, type PixelArray, pixelsOf } from "../values/pixels.js";
import { finiteNumbers, flattened, optionsOf, part, whole } from "../values/validation.js";

/**
 * Encodes a mask in COCO's run-length encoding, like pycocotools.
 *
 * @param mask `{ data, width, height }`, row-major; non-zero is the object
 * @param options `compressed`: if `true` (the default), `counts` is a string, as in COCO's result files; otherwise, it
 * is an array of run lengths, as in crowd annotations
 * @returns `size` is [height, width]
 *
 * @example
 * toCocoRle({ data: Uint8Array.of(0, 1, 1, 1), width: 2, height: 2 }, { compressed: false }).counts;    // [1, 3]
 * @throws {@link Sim3AlignError} for a mask of the wrong type or length
 */
export function toCocoRle(mask: PixelArray<MaskPixels>, options?: { compressed?: true }): CocoRle & { counts: string };
export function toCocoRle(
  mask: PixelArray<MaskPixels>,
  options: { compressed: false },
): CocoRle & { counts: readonly number[] };
export function toCocoRle(mask: PixelArray<MaskPixels>, options: { compressed?: boolean } = {}): CocoRle {
  const { compressed = true } = optionsOf(options, ["compressed"]);
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

/** Decodes a mask, compressed or not; `argument` is the name of the encoding in errors. */
export function decodedRle(argument: string, rle: unknown): PixelArray<Uint8Array> {
  const { size, counts } = part(argument, rle, "{ size: [height, width], counts }");
  const [height, width] = finiteNumbers(`${argument}.size`, size, 2, "[height, width]") as [number, number];
  const runs = runsOf(`${argument}.counts`, counts);
  checkSize(`${argument}.size`, { width, height });
  const columns = filledRuns(`${argument}.counts`, runs, width * height);
  const data = new Uint8Array(columns.length);
  for (let place = 0; place < data.length; place++) {
    data[(place % height) * width + Math.floor(place / height)] = columns[place] ?? 0;
  }
  return { data, width, height };
}

/** The validated run lengths of an array or a compressed string. */
function runsOf(argument: string, counts: unknown): number[] {
  if (typeof counts === "string") return decompressed(argument, counts);
  const runs = flattened(counts);
  if (runs !== null) return runs as number[];
  const remedy = 'Pass `counts` as COCO\'s files hold it. Bytes of Python become a string by rle["counts"].decode().';
  throw failure("INVALID_ARGUMENT", argument, describe(counts), "a string, or an array of run lengths", remedy);
}

/** Checks a size before allocation, because the file may be malicious. */
function checkSize(argument: string, { width, height }: ImageSize): void {
  whole(`${argument}.width`, width, 0);
  whole(`${argument}.height`, height, 0);
  const found = `${width} × ${height} pixels`;
  if (width * height === 0) {
    throw failure("EMPTY_IMAGE", argument, found, "at least one pixel", "Pass [height, width] of the image.");
  }
  if (width * height <= MAX_PIXELS) return;
  const remedy = "Downscale the mask first; if the file is small, it is corrupt or malicious.";
  throw failure("FILE_TOO_LARGE", argument, found, `at most ${MAX_PIXELS} pixels (8192 × 8192)`, remedy);
}

/**
 * Decodes alternating runs: 0 in the first run, 1 in the second, and so on.
 * @param count the required sum of the runs
 */
export function filledRuns(argument: string, runs: readonly unknown[], count: number): Uint8Array {
  const corrupt = (found: string) => {
    const expected = `run lengths that add up to ${count}`;
    return failure("CORRUPT_FILE", argument, found, expected, "Pass the runs with the size of their image.");
  };
  // Checked before allocation, because the size may be malicious.
  let total = 0;
  for (const run of runs) {
    if (!Number.isSafeInteger(run) || (run as number) < 0) throw corrupt(`${describe(run)} among the runs`);
    total += run as number;
  }
  if (total !== count) throw corrupt(`runs of ${total} pixels in total`);
  const pixels = new Uint8Array(count);
  let start = 0;
  runs.forEach((run, i) => {
    const end = start + (run as number);
    if (i % 2 === 1) pixels.fill(1, start, end);
    start = end;
  });
  return pixels;
}

// Each character encodes five bits, the least significant first, and a sixth bit that is set if more characters follow;
// character codes start at "0". From the fourth run on, values are differences to the run two before.
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

function decompressed(argument: string, text: string): number[] {
  const broken = (found: string) => {
    const remedy = "Pass counts as pycocotools writes them, decoded as ASCII.";
    return failure("CORRUPT_FILE", argument, found, "a string of COCO's run lengths", remedy);
  };
  const counts: number[] = [];
  let value = 0;
  let factor = 1;
  for (const letter of text) {
    const six = (letter.codePointAt(0) ?? 0) - firstLetter;
    if (six < 0 || six > 63) throw broken(`the character ${JSON.stringify(letter)}`);
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
