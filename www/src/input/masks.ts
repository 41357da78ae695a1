/** Reads masks. */
import { Sim3AlignError } from "sim3align";
import { resizedMask } from "sim3align/conventions/resize";
import type { MaskSource, NamedFile } from "../state/inputs.js";
import { once } from "../state/once.js";
import { extension } from "./files.js";
import { photoExtensions } from "./photo.js";
import { type ReadMask, readMask } from "./reader.js";

const plainMask = once(async (file: NamedFile): Promise<ReadMask> => {
  const ending = extension(file.path);
  if (photoExtensions.includes(ending) && !ending.startsWith("jp"))
    return (await import("./label-masks.js")).maskOfPicture(file);
  return readMask(await file.bytes());
});

/** The mask of a source. */
export async function maskOf(source: MaskSource): Promise<ReadMask> {
  const mask = await markedBy(source);
  if (source.isInverted !== true) return mask;
  return { ...mask, data: mask.data.map((inside) => (inside === 0 ? 1 : 0)), reading: "inverted" };
}

/** Label maps and annotations are read by a script of their own. */
async function markedBy(source: MaskSource): Promise<ReadMask> {
  const { file, label, annotation } = source;
  if (label !== undefined || annotation !== undefined) return (await import("./label-masks.js")).maskFrom(source);
  return plainMask(file);
}

/** The mask at the size of the depth map. */
export function atSize(mask: ReadMask, width: number, height: number, resize: boolean): Uint8Array {
  if (mask.width === width && mask.height === height) return mask.data;
  if (resize) return resizedMask(mask, { width, height }).data;
  throw new Sim3AlignError({
    code: "SIZE_MISMATCH",
    argument: "mask",
    found: `${mask.width} × ${mask.height} pixels`,
    expected: `${width} × ${height}, the size of the depth map`,
    remedy: "Export the mask at the size of the depth map, or resize it.",
  });
}
