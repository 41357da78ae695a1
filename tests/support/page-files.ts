/** Files that the tests of the page drop on it. */
import assert from "node:assert/strict";
import { zipSync } from "fflate";
import { maskPng as maskFile, npy, obj } from "./files.js";
import { mesh, pinhole, view } from "./scene.js";
import type { SitePage } from "./site.js";

/** Files by name. */
export type Files = Record<string, Uint8Array>;

/** The view of the object, and the size of all images. */
export const seen = view;
export const { width: WIDTH, height: HEIGHT } = view;

/** A JSON file. */
export const jsonFile = (content: unknown) => Buffer.from(JSON.stringify(content));

export const cameraFile = jsonFile({ ...pinhole, width: WIDTH, height: HEIGHT });

/** A depth map, metres. */
export const depthNpy = (depth: Float32Array) => npy(depth, HEIGHT, WIDTH);

/** A mask as a PNG of 0 and 255. */
export const maskPng = (mask: Uint8Array) => maskFile(mask, WIDTH, HEIGHT);

/** A complete case of one object. */
export const files: Files = {
  "depth.npy": depthNpy(seen.depth),
  "mask.png": maskPng(seen.mask),
  "camera.json": cameraFile,
  "mesh.obj": obj(mesh),
};

/** The files, in a folder. */
export const inFolder = (folder: string, content: Files): Files =>
  Object.fromEntries(Object.entries(content).map(([name, bytes]) => [`${folder}/${name}`, bytes]));

/** Drops files on the page. */
export async function drop({ page }: SitePage, dropped: Files): Promise<void> {
  const encoded = Object.entries(dropped).map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]);
  const data = await page.evaluateHandle((parts) => {
    const transfer = new DataTransfer();
    for (const [name = "", base64 = ""] of parts) {
      const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
      transfer.items.add(new File([bytes], name));
    }
    return transfer;
  }, encoded);
  await page.dispatchEvent("body", "dragenter", { dataTransfer: data });
  assert.ok(await page.isVisible(".drop-here"));
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
}

/** Drops a folder as a zip archive. */
export const dropFolder = (opened: SitePage, dropped: Files) =>
  drop(opened, { "folder.zip": Buffer.from(zipSync(dropped)) });

/** Chooses a file for a field of the intake sheet. */
export const choose = ({ page }: SitePage, field: string, name: string, bytes: Uint8Array) =>
  page.setInputFiles(`#${field}-file`, { name, mimeType: "", buffer: Buffer.from(bytes) });
