/** Converts masks to bytes with their size. */
import { checkAttached } from "../attached.js";
import { invalidArgument } from "../error.js";
import { decodedRle, readRleFile } from "../formats/coco-rle.js";
import type { LoadFormats } from "../formats-module.js";
import { isRecord, isTypedArray, wrongKind } from "../values.js";
import { beginsLikeImage, beginsLikeJson, fileBytes } from "./bytes.js";
import type { SizedArray } from "./depth.js";

type MaskArray = Uint8Array | Uint8ClampedArray;

const kinds =
  "a Uint8Array (non-zero is the object), { data, width, height } with one, COCO RLE { size, counts }, or the bytes of a PNG or a .npy file";

/** The pixels of a mask.
 * @param pixels the number of pixels of the depth map
 */
export async function readMask(mask: unknown, pixels: number, formats: LoadFormats): Promise<SizedArray<MaskArray>> {
  if (isRecord(mask)) {
    if ("counts" in mask) return decodedRle("mask", mask);
    if ("data" in mask) {
      const { data, width, height } = mask as { data: unknown; width: number; height: number };
      if (!isMaskArray(data)) throw wrongKind("mask.data", data, "a Uint8Array", "Uint8Array");
      if (typeof width === "number" && typeof height === "number") return { data, width, height };
      throw invalidArgument("mask", mask, "data, width and height", "Pass the width and height of the mask in pixels.");
    }
  }
  if (isTypedArray<Uint8ClampedArray>(mask, "Uint8ClampedArray")) return bare(mask);
  const bytes = await fileBytes("mask", mask);
  if (bytes === null) throw wrongKind("mask", mask, kinds, "Uint8Array");
  const isImage = beginsLikeImage(bytes);
  if (!isImage && (bytes.length === pixels || (mask === bytes && !beginsLikeJson(bytes)))) return bare(bytes);
  if (!isImage && beginsLikeJson(bytes)) return readRleFile("mask", bytes);
  const module = await formats();
  checkAttached("mask", bytes);
  return module.call((readers) => readers.readMask(bytes));
}

const bare = (data: MaskArray): SizedArray<MaskArray> => ({ data, width: undefined, height: undefined });

const isMaskArray = (value: unknown): value is MaskArray => isTypedArray(value, "Uint8Array", "Uint8ClampedArray");
