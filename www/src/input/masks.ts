/** Reads masks. */
import { Sim3AlignError } from "sim3align";
import { resizedMask } from "sim3align/conventions/resize";
import type { MaskSource, NamedFile } from "../state/inputs.js";
import { once } from "../state/once.js";
import { type ReadMask, readMask } from "./reader.js";

const markedBy = once(async (file: NamedFile): Promise<ReadMask> => readMask(await file.bytes()));

/** The mask of a source. */
export async function maskOf(source: MaskSource): Promise<ReadMask> {
  const mask = await markedBy(source.file);
  if (source.isInverted !== true) return mask;
  return { ...mask, data: mask.data.map((inside) => (inside === 0 ? 1 : 0)), reading: "inverted" };
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
