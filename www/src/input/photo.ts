/** Reads photos. */
import { extensionsOf } from "sim3align/input/formats";
import type { NamedFile } from "../state/inputs.js";

/** A photo with its own size, and its pixels at that of the depth map. */
export interface Photo {
  rgba: Uint8ClampedArray;
  width: number;
  height: number;
  /** The size of `rgba`. */
  shown: Size;
  /** Whether its EXIF data are passed over, by which it would not have the shape of the depth map. */
  isAsTaken: boolean;
}

interface Size {
  width: number;
  height: number;
}

/** Images that are photos, or masks, but no depth maps; some only the browser decodes. */
export const photoExtensions = [
  ...extensionsOf("photo").filter((ending) => ending !== "png"),
  ...["avif", "heic", "heif"],
];

/** The longest side of a photo that is shown without a depth map, pixels. */
const MAX_SIDE = 1280;

/** The pixels of a photo, decoded by the browser and resized, or reduced to a limited size: red, green, blue, alpha. */
export async function readPhoto(file: NamedFile, size: Size | null): Promise<Photo> {
  return photoFrom(new Blob([(await file.bytes()) as Uint8Array<ArrayBuffer>]), size);
}

/** The pixels of an image, resized. */
export async function photoFrom(source: Blob | ImageData, size: Size | null): Promise<Photo> {
  const decoded = (options?: ImageBitmapOptions) =>
    createImageBitmap(source, options).catch(() => {
      throw new Error("The browser cannot decode this image. Choose a JPEG, PNG or WebP file.");
    });
  let bitmap = await decoded();
  const isUpright = ({ width, height }: Size) => height > width;
  let isAsTaken = false;
  if (size !== null && source instanceof Blob && isUpright(bitmap) !== isUpright(size)) {
    const taken = await decoded({ imageOrientation: "none" });
    isAsTaken = isUpright(taken) === isUpright(size);
    if (isAsTaken) bitmap = taken;
  }
  const { width, height } = bitmap;
  const scale = Math.min(1, MAX_SIDE / Math.max(width, height));
  const shown = size ?? { width: Math.ceil(scale * width), height: Math.ceil(scale * height) };
  const context = new OffscreenCanvas(shown.width, shown.height).getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("The browser could not create a canvas for the photo.");
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, shown.width, shown.height);
  bitmap.close();
  return { rgba: context.getImageData(0, 0, shown.width, shown.height).data, width, height, shown, isAsTaken };
}
