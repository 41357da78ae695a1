/** Reads photos. */
import type { NamedFile } from "./files.js";

/** A photo at the size of the depth map, with its own size. */
export interface Photo {
  rgba: Uint8ClampedArray;
  width: number;
  height: number;
}

/** The pixels of a photo, decoded by the browser and resized: red, green, blue, alpha. */
export async function readPhoto(file: NamedFile, size: { width: number; height: number }): Promise<Photo> {
  return photoFrom(new Blob([(await file.bytes()) as Uint8Array<ArrayBuffer>]), size);
}

/** The pixels of an image, resized. */
export async function photoFrom(source: Blob | ImageData, size: { width: number; height: number }): Promise<Photo> {
  const bitmap = await createImageBitmap(source).catch(() => {
    throw new Error("The browser cannot decode this image. Choose a JPEG, PNG or WebP file.");
  });
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(size.width, size.height).getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("The browser could not create a canvas for the photo.");
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, size.width, size.height);
  bitmap.close();
  return { rgba: context.getImageData(0, 0, size.width, size.height).data, width, height };
}
