/** Photos, decoded by the browser. */
import type { NamedFile } from "./named-file.js";

/** A photo's pixels at another size: red, green, blue, opacity. */
export async function readPhoto(file: NamedFile, width: number, height: number): Promise<Uint8ClampedArray> {
  const blob = new Blob([Uint8Array.from(await file.bytes())]);
  const bitmap = await createImageBitmap(blob).catch(() => {
    throw new Error("This is not an image that the browser can show. Choose a JPEG, PNG or WebP file.");
  });
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("The browser gives no canvas to draw the photo on.");
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  return context.getImageData(0, 0, width, height).data;
}
