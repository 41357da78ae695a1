/** Files of what was marked or found on a photo. */
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
  return inMemory(`${name}-mask.png`, new Uint8Array(await (await context.canvas.convertToBlob()).arrayBuffer()));
}

function contextOf({ width, height }: Size): OffscreenCanvasRenderingContext2D {
  const context = new OffscreenCanvas(width, height).getContext("2d");
  if (context === null) throw new Error("The browser could not create a canvas for the mask.");
  return context;
}

/** A file that was made here. */
const inMemory = (path: string, bytes: Uint8Array): NamedFile => ({
  path,
  bytes: async () => bytes,
  head: async (length) => bytes.subarray(0, length),
  size: bytes.length,
});

/** A depth map as a `.npy` file of 32-bit floats, version 1.0. */
export function depthFile(data: Float32Array, { width, height }: Size, name: string): NamedFile {
  const dict = `{'descr': '<f4', 'fortran_order': False, 'shape': (${height}, ${width}), }`;
  // The header, with its length in two bytes, ends at a multiple of 64 bytes.
  const text = `${dict.padEnd(64 * Math.ceil((dict.length + 11) / 64) - 11)}\n`;
  const header = Uint8Array.from(`\x93NUMPY\x01\x00\0\0${text}`, (letter) => letter.charCodeAt(0));
  const bytes = new Uint8Array(header.length + 4 * data.length);
  bytes.set(header);
  const view = new DataView(bytes.buffer);
  view.setUint16(8, text.length, true);
  for (const [i, value] of data.entries()) view.setFloat32(header.length + 4 * i, value, true);
  return inMemory(`${name}-depth.npy`, bytes);
}
