/** Converts masks to bytes with their size. */

import type { LoadFormats } from "../modules/readers.js";
import { failure, invalidArgument } from "../values/error.js";
import { isKind, isRecord, isTypedArray } from "../values/kinds.js";
import { wrongKind } from "../values/validation.js";
import { type Bytes, beginsLikeImage, beginsLikeJson, callReader, fileBytes, isBytes } from "./bytes.js";
import { decodedRle, isPolygons, polygons, readRleFile } from "./coco-rle.js";
import type { SizedArray } from "./depth.js";
import { formatsText } from "./formats.js";

const kinds = () =>
  `a Uint8Array (non-zero is the object), { data, width, height } with one, COCO RLE { size, counts }, or the bytes of a file: ${formatsText("mask")}`;

/** A mask for the core. */
export interface ReadMask extends SizedArray<Bytes> {
  /** The values of its file that are the object, for people. */
  reading?: string;
  /** What the file holds besides, and its reader does not know. */
  unread?: readonly string[];
}

/** The pixels of a mask.
 * @param pixels the number of pixels of the depth map
 */
export async function readMask(mask: unknown, pixels: number, formats: LoadFormats): Promise<ReadMask> {
  if (isPolygons(mask)) throw polygons("mask");
  if (isRecord(mask)) {
    if (isPolygons(mask.segmentation)) throw polygons("mask.segmentation");
    if ("counts" in mask) return decodedRle("mask", mask);
    if ("data" in mask) {
      const { data, width, height } = mask as { data: unknown; width: number; height: number };
      if (!isBytes(data)) throw wrongKind("mask.data", data, "a Uint8Array", "Uint8Array");
      if (typeof width !== "number" || typeof height !== "number") {
        const remedy = "Pass the width and height of the mask in pixels.";
        throw invalidArgument("mask", mask, "data, width and height", remedy);
      }
      checkChannels("mask.data", data, width * height);
      return { data, width, height };
    }
  }
  if (isTypedArray<Uint8ClampedArray>(mask, "Uint8ClampedArray")) {
    checkChannels("mask", mask, pixels);
    return bare(mask);
  }
  if (isKind(mask, "ImageData")) throw invalidArgument("mask", mask, kinds(), "Pass one channel of its data.");
  const bytes = await fileBytes("mask", mask);
  if (bytes === null) throw wrongKind("mask", mask, kinds(), "Uint8Array");
  const isImage = beginsLikeImage(bytes);
  if (!isImage && (bytes.length === pixels || (mask === bytes && !beginsLikeJson(bytes)))) {
    checkChannels("mask", bytes, pixels);
    return bare(bytes);
  }
  if (!isImage && beginsLikeJson(bytes)) return readRleFile("mask", bytes);
  return callReader(formats, "mask", bytes, (readers) => readers.readMask(bytes));
}

/** Explains the length of an image with several values per pixel. The core checks every other length. */
function checkChannels(argument: string, { length }: Bytes, pixels: number): void {
  const channels = length / pixels;
  if (![2, 3, 4].includes(channels)) return;
  const found = `${length} values, ${channels} per pixel`;
  const remedy =
    channels === 4
      ? `Pass one channel of the RGBA image: ${argument}.filter((_, i) => i % 4 === 0) is red, i % 4 === 3 the opacity.`
      : `Pass one channel of the image, such as ${argument}.filter((_, i) => i % ${channels} === 0).`;
  throw failure("WRONG_LENGTH", argument, found, `${pixels} values, one per pixel`, remedy);
}

const bare = (data: Bytes): SizedArray<Bytes> => ({ data, width: undefined, height: undefined });
