/** Converts masks to bytes with their size. */

import type { LoadFormats } from "../modules/readers.js";
import { failure, invalidArgument } from "../values/error.js";
import { type JsonFile, parsedJson } from "../values/json.js";
import { isKind, isRecord, isTypedArray } from "../values/kinds.js";
import type { ImageSize } from "../values/pixels.js";
import { wrongKind } from "../values/validation.js";
import { type Bytes, beginsLikeImage, beginsLikeJson, callReader, fileBytes, isBytes } from "./bytes.js";
import type { SizedArray } from "./depth.js";
import { formatsText } from "./formats.js";

const kinds = () =>
  `a Uint8Array (non-zero is the object), { data, width, height } with one, COCO RLE { size, counts }, or the bytes of a file: ${formatsText("mask")}`;

/** A mask for the core. */
export interface ReadMask extends SizedArray<Bytes> {
  /** The values of its file that are the object, for people. */
  reading?: string;
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
}

/** Keys of JSON objects with masks. */
const jsonKeys = ["segmentation", "annotations", "shapes", "objects", "regions", "_via_img_metadata"];

/** Whether an object is the content of a JSON file with masks. */
const isJson = (mask: unknown): mask is object =>
  Array.isArray(mask) ? typeof mask[0] === "object" : isRecord(mask) && jsonKeys.some((key) => key in mask);

/**
 * The mask in JSON: bytes, or their parsed content.
 * @param index its place among several
 * @param size that of the depth map, for polygons whose file states none
 */
export async function readJsonMask(
  argument: string,
  file: JsonFile,
  index: unknown,
  size: ImageSize | undefined,
  formats: LoadFormats,
): Promise<ReadMask> {
  const { maskInJson } = await import("./mask-file.js");
  return maskInJson(argument, parsedJson(argument, file), index, size, formats);
}

/**
 * The pixels of a mask.
 * @param size that of the depth map
 * @param index the place of the mask in a JSON file of several
 */
export async function readMask(
  mask: unknown,
  size: ImageSize,
  formats: LoadFormats,
  index?: unknown,
): Promise<ReadMask> {
  const pixels = size.width * size.height;
  const bytes = isJson(mask) ? null : await fileBytes("mask", mask);
  const isImage = bytes !== null && beginsLikeImage(bytes);
  const isText = bytes !== null && !isImage && bytes.length !== pixels && beginsLikeJson(bytes);
  if (isJson(mask) || isText) return readJsonMask("mask", isText ? bytes : (mask as object), index, size, formats);
  if (index !== undefined) {
    throw invalidArgument(
      "maskIndex",
      index,
      "nothing beside a mask of its own",
      "It is for JSON files of several masks.",
    );
  }
  if (isRecord(mask)) {
    if ("counts" in mask) return (await import("./coco-rle.js")).decodedRle("mask", mask);
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
  if (bytes === null) throw wrongKind("mask", mask, kinds(), "Uint8Array");
  if (!isImage && (bytes.length === pixels || mask === bytes)) {
    checkChannels("mask", bytes, pixels);
    return bare(bytes);
  }
  return callReader(formats, "mask", bytes, (readers) => readers.readMask(bytes));
}

/** Relative difference of the ratios of the sides, up to which two images have the same shape: networks round to multiples of 14. */
const SAME_SHAPE = 0.04;

/**
 * A mask that can be resized to a depth map: the image in the corner of a square, as SAM pads it.
 * @throws {@link Sim3AlignError} `SIZE_MISMATCH` for a mask of another shape, which would be stretched
 */
export function shapedMask(argument: string, mask: ReadMask, depth: ImageSize, resize: unknown): ReadMask {
  const { data, width = depth.width, height = depth.height } = mask;
  const ratio = (width * depth.height) / (height * depth.width);
  if (!(width * height === data.length && Math.abs(Math.log(ratio)) > SAME_SHAPE)) return mask;
  let isPadded = false;
  if (width === height) {
    const scale = width / Math.max(depth.width, depth.height);
    const [columns, rows] = [depth.width, depth.height].map((side) => Math.round(side * scale)) as [number, number];
    isPadded = !data.some((pixel, i) => pixel !== 0 && (i % width >= columns || i >= rows * width));
    if (isPadded && resize === "nearest") {
      const inside = data.filter((_, i) => i % width < columns && i < rows * width);
      const padded = `the upper left ${columns} × ${rows} of ${width} × ${height} pixels, a padded square`;
      return {
        ...mask,
        data: inside,
        width: columns,
        height: rows,
        reading: [mask.reading, padded].filter(Boolean).join("; "),
      };
    }
  }
  const found = `${width} × ${height} pixels for a depth map of ${depth.width} × ${depth.height}, of another shape`;
  const remedy = isPadded
    ? 'It may be the square to which SAM pads an image: with resizeMask: "nearest", its part with the image is read. Else crop or pad it to the view of the depth map.'
    : "It shows another field of view, and would be stretched: crop or pad it to that of the depth map, or warp it with both cameras.";
  throw failure("SIZE_MISMATCH", argument, found, "a mask of the view of the depth map", remedy);
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
