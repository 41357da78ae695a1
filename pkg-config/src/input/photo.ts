/** The photo of an input. */

import type { Photo } from "../modules/core-input.js";
import type { Exif } from "../types/files.js";
import { failure, invalidArgument } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import type { PixelArray } from "../values/pixels.js";
import { wrongKind } from "../values/validation.js";
import { type Bytes, beginsLikeImage, callReader, fileBytes, isBytes } from "./bytes.js";
import { photoOf } from "./colors.js";
import type { StatedSize } from "./depth.js";
import { formatsText } from "./formats.js";
import { type ImageReaders, isWebp } from "./webp.js";

const kinds = () =>
  `a Uint8Array of RGB or RGBA pixels, { data, width, height } with one, an ImageData, or the bytes of a file: ${formatsText("photo")}`;

/** A photo for the core. */
export interface ReadPhoto {
  image?: Photo;
  /** Its orientation, if not that of its EXIF data. */
  imageReading?: string;
}

/**
 * The pixels of a photo, if there is one.
 * @param size the size of the depth map, which is that of a bare array
 */
export async function readPhoto(image: unknown, size: StatedSize, readers: ImageReaders): Promise<ReadPhoto> {
  if (image === undefined || image === null) return {};
  if (isRecord(image) && "data" in image) {
    const { data, width, height } = image;
    if (!isBytes(data)) throw wrongKind("image.data", data, "a Uint8Array of RGB or RGBA pixels", "Uint8Array");
    return { image: pixels("image.", data, { width, height } as StatedSize) };
  }
  if (isTypedArray<Uint8ClampedArray>(image, "Uint8ClampedArray")) return { image: pixels("", image, size) };
  const bytes = await fileBytes("image", image);
  if (bytes === null) throw wrongKind("image", image, kinds(), "Uint8Array");
  if (bytes === image && !beginsLikeImage(bytes) && channelsOf(bytes, size) !== undefined)
    return { image: pixels("", bytes, size) };
  const photo = await decodePhoto(bytes, readers);
  if (isShapeOf(photo, size) || !isShapeOf({ width: photo.height, height: photo.width }, size)) return { image: photo };
  // EXIF data turn the photo, but the depth map is as the sensor read it.
  const stored = await decodePhoto(bytes, readers, true);
  return isShapeOf(stored, size)
    ? { image: stored, imageReading: "as stored, in the shape of the depth map" }
    : { image: photo };
}

/**
 * The pixels of an image file.
 * @param asStored whether they are wanted without the orientation of the EXIF data
 */
export function decodePhoto(
  bytes: Uint8Array,
  { formats, webp }: ImageReaders,
  asStored = false,
): Promise<PixelArray<Uint8Array>> {
  return isWebp(bytes)
    ? callReader(webp, "image", bytes, (reader) => reader.decodeWebp(bytes, asStored))
    : callReader(formats, "image", bytes, (reader) => reader.readImage(bytes, asStored));
}

/** The EXIF data of an image file. */
export async function decodeExif(bytes: Uint8Array, { formats, webp }: ImageReaders): Promise<Exif> {
  const data = isWebp(bytes)
    ? (await callReader(webp, "image", bytes, (reader) => reader.decodeWebp(bytes, true))).exif
    : bytes;
  if (data === undefined) return { orientation: 1 };
  return callReader(formats, "image", data, (reader) => reader.readExif(data));
}

/** Whether an image has the shape of another one. */
const isShapeOf = (image: StatedSize, { width, height }: StatedSize): boolean =>
  Math.abs(Math.log((Number(image.width) * Number(height)) / (Number(image.height) * Number(width)))) < 0.05;

/** The EXIF data of a photo, if it is a file. */
export async function readPhotoExif(image: unknown, readers: ImageReaders): Promise<Exif | undefined> {
  const bytes = isTypedArray(image, "Uint8ClampedArray") ? null : await fileBytes("image", image);
  if (bytes === null || !beginsLikeImage(bytes)) return undefined;
  return decodeExif(bytes, readers);
}

const channelsOf = ({ length }: Bytes, { width, height }: StatedSize): number | undefined =>
  [3, 4].find((channels) => length > 0 && length === Number(width) * Number(height) * channels);

/** `owner` is what has the size, for errors: `image.`, or nothing for the input. */
function pixels(owner: "" | "image.", data: Bytes, { width, height }: StatedSize): Photo {
  for (const [name, side] of Object.entries({ width, height })) {
    if (Number.isSafeInteger(side) && (side as number) >= 0) continue;
    throw invalidArgument(`${owner}${name}`, side, "an integer in pixels", "Pass the size of the image.");
  }
  const size = { width, height } as { width: number; height: number };
  const channels = channelsOf(data, size);
  if (channels !== undefined) return photoOf(data, channels, size.width, size.height);
  const pixels = size.width * size.height;
  const expected = `${3 * pixels} or ${4 * pixels}, RGB or RGBA for ${width} × ${height} pixels`;
  const remedy = "Pass { data, width, height } for a photo of another size than the depth map.";
  throw failure("WRONG_LENGTH", owner === "" ? "image" : "image.data", `${data.length} values`, expected, remedy);
}
