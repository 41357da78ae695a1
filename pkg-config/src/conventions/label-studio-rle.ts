/** Brush masks in Label Studio's format: a bit stream of the flattened RGBA pixels. */

import { describe, failure } from "../values/error.js";
import { type PixelArray, sizeOf } from "../values/pixels.js";
import { flattened } from "../values/validation.js";

/** Decodes the bytes of a brush annotation. */
export function decodedLabelStudio(rle: unknown, image: unknown): PixelArray<Uint8Array> {
  const { width, height } = sizeOf("image", image);
  const bits = new BitReader(bytesOf(rle));
  const count = bits.read(32);
  if (count !== 4 * width * height) {
    const found = `${count} values for an image of ${width} × ${height}`;
    const remedy = "Pass the result's original_width and original_height.";
    throw failure("SIZE_MISMATCH", "rle", found, `width × height × 4 = ${4 * width * height}`, remedy);
  }
  const wordBits = bits.read(5) + 1;
  // Number of bits of a run length, selected by the two bits before it.
  const lengthBits = [bits.read(4) + 1, bits.read(4) + 1, bits.read(4) + 1, bits.read(4) + 1];
  const data = new Uint8Array(width * height);
  for (let place = 0; place < count; ) {
    const isRun = bits.read(1) === 1;
    const length = bits.read(lengthBits[bits.read(2)] ?? 1) + 1;
    const end = place + length;
    if (end > count) {
      throw failure("CORRUPT_FILE", "rle", `a run up to ${end}`, `${count} values in all`, "Pass value.rle unchanged.");
    }
    if (isRun) {
      // The brush is in the alpha channel: value 4·i + 3 of pixel i.
      if (bits.read(wordBits) !== 0) data.fill(1, Math.floor(place / 4), Math.floor(end / 4));
    } else {
      for (; place < end; place++) {
        if (bits.read(wordBits) !== 0 && place % 4 === 3) data[(place - 3) / 4] = 1;
      }
    }
    place = end;
  }
  return { data, width, height };
}

function bytesOf(rle: unknown): ArrayLike<number> {
  const bytes = flattened(rle) as number[] | null;
  if (bytes?.every((byte) => Number.isInteger(byte) && byte >= 0 && byte < 256)) return bytes;
  const expected = "bytes: integers from 0 to 255";
  throw failure("INVALID_ARGUMENT", "rle", describe(rle), expected, "Pass value.rle of a result of type brushlabels.");
}

/** Reads bits from bytes, the most significant first. */
class BitReader {
  #place = 0;

  constructor(private readonly bytes: ArrayLike<number>) {}

  /** Reads an unsigned integer of up to 32 bits. */
  read(count: number): number {
    let value = 0;
    for (let left = count; left > 0; ) {
      const byte = this.bytes[this.#place >> 3];
      if (byte === undefined) {
        const found = `${this.bytes.length} bytes, which are truncated`;
        throw failure("CORRUPT_FILE", "rle", found, "a complete mask", "Pass value.rle unchanged.");
      }
      const unread = 8 - (this.#place & 7);
      const taken = Math.min(unread, left);
      value = value * 2 ** taken + ((byte >> (unread - taken)) & (2 ** taken - 1));
      this.#place += taken;
      left -= taken;
    }
    return value;
  }
}
