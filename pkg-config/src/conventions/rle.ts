/** Masks of annotation tools in run-length encodings. */
import { decodedRle } from "../input/coco-rle.js";
import type { CocoRle } from "../types/inputs.js";
import { plainArgument } from "../values/border.js";
import type { ImageSize, PixelArray } from "../values/pixels.js";
import { oneOf } from "../values/validation.js";
import { type CvatMaskElement, decodedCvat } from "./cvat-rle.js";
import { decodedLabelStudio } from "./label-studio-rle.js";

/**
 * Decodes a mask in COCO's run-length encoding, compressed or not. `align` accepts the encoding as `mask` directly.
 * @returns 1 is the object
 *
 * @example
 * fromRle({ size: [2, 2], counts: [1, 3] }).data;    // Uint8Array [0, 1, 1, 1]
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` if the runs do not add up to the image size
 */
export function fromRle(rle: CocoRle, format?: "coco"): PixelArray<Uint8Array>;
/**
 * Decodes a mask of CVAT: the `points` of a mask shape from its API or SDK (run lengths, then left, top, right and
 * bottom of the box, all inclusive), or a `<mask>` element of its XML.
 *
 * @param rle the `points`, or the attributes of the element, which may be strings
 * @param image the size of the whole image, in pixels
 * @returns the mask of the whole image; 1 is the object
 *
 * @example
 * fromRle([1, 2, 1, 1, 0, 2, 1], "cvat", { width: 3, height: 2 }).data;    // Uint8Array [0, 0, 1, 0, 1, 0]
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` for runs that do not fill the box, `SIZE_MISMATCH` if the box exceeds
 * the image
 */
export function fromRle(
  rle: ArrayLike<number> | CvatMaskElement,
  format: "cvat",
  image: ImageSize,
): PixelArray<Uint8Array>;
/**
 * Decodes a brush annotation of Label Studio (`BrushLabels`, `format: "rle"`).
 *
 * @param rle the bytes in `value.rle`
 * @param image the image's size in pixels: the result's `original_width` and `original_height`
 * @returns 1 is the object: pixels whose alpha is not 0
 *
 * @example
 * const { value, original_width: width, original_height: height } = annotation.result[0];
 * const mask = fromRle(value.rle, "label-studio", { width, height });
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` for truncated data, `SIZE_MISMATCH` for data of an image of another
 * size
 */
export function fromRle(rle: ArrayLike<number>, format: "label-studio", image: ImageSize): PixelArray<Uint8Array>;
export function fromRle(
  rle: CocoRle | CvatMaskElement | ArrayLike<number>,
  format: "coco" | "cvat" | "label-studio" = "coco",
  image?: ImageSize,
): PixelArray<Uint8Array> {
  const name = oneOf("format", format, ["coco", "cvat", "label-studio"], "INVALID_ARGUMENT");
  if (name === "coco") return decodedRle("rle", plainArgument("rle", rle));
  return name === "cvat" ? decodedCvat(rle, image) : decodedLabelStudio(rle, image);
}
