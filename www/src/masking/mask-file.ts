/** The file of a mask that was marked on a photo. */
import type { NamedFile } from "../state/inputs.js";

interface Size {
  width: number;
  height: number;
}

/** A mask as a PNG of black and white, resized to the image to which it belongs. */
export async function maskFile(mask: Uint8Array, of: Size, size: Size, name: string): Promise<NamedFile> {
  const own = new ImageData(of.width, of.height);
  new Uint32Array(own.data.buffer).set(Uint32Array.from(mask, (inside) => (inside === 0 ? 0xff000000 : 0xffffffff)));
  const drawn = contextOf(of);
  drawn.putImageData(own, 0, 0);
  const context = contextOf(size);
  context.imageSmoothingEnabled = false;
  context.drawImage(drawn.canvas, 0, 0, size.width, size.height);
  const bytes = new Uint8Array(await (await context.canvas.convertToBlob()).arrayBuffer());
  return { path: `${name}-mask.png`, bytes: async () => bytes, size: bytes.length };
}

function contextOf({ width, height }: Size): OffscreenCanvasRenderingContext2D {
  const context = new OffscreenCanvas(width, height).getContext("2d");
  if (context === null) throw new Error("The browser could not create a canvas for the mask.");
  return context;
}
