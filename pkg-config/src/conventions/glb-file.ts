/** GLB files: JSON, and chunks of bytes. */
import { bytesOfFile } from "../input/bytes.js";
import { describe, failure } from "../values/error.js";
import { isRecord } from "../values/kinds.js";

/** The content of a GLB file. */
export interface GlbFile {
  json: Record<string, unknown>;
  /** The other chunks; the first one is the buffer, if there is one. */
  chunks: readonly GlbChunk[];
}

export type GlbChunk = readonly [type: number, content: Uint8Array];

const magic = 0x46546c67;
const jsonChunk = 0x4e4f534a;
/** The type of the chunk that is the buffer. */
export const binaryChunk = 0x004e4942;

/**
 * Reads a GLB file.
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` if the bytes are not a GLB, `UNSUPPORTED_FORMAT` for glTF 1
 */
export function readGlb(glb: unknown): GlbFile {
  const bytes = bytesOfFile("glb", glb, "the bytes of a GLB file");
  const corrupt = (found: string) =>
    failure("CORRUPT_FILE", "glb", found, "a complete GLB file", "Pass the aligned file unchanged.");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== magic)
    throw corrupt(`${bytes.length} bytes without a GLB header`);
  const [version, length] = [view.getUint32(4, true), view.getUint32(8, true)];
  if (version !== 2) {
    throw failure("UNSUPPORTED_FORMAT", "glb", `glTF ${version}`, "glTF 2", "Convert it to glTF 2 first.");
  }
  if (length > bytes.length) throw corrupt(`${bytes.length} bytes of ${length}`);
  const chunks: GlbChunk[] = [];
  for (let place = 12; place + 8 <= length; ) {
    const end = place + 8 + view.getUint32(place, true);
    if (end > length) throw corrupt(`a chunk up to byte ${end} of ${length}`);
    chunks.push([view.getUint32(place + 4, true), bytes.subarray(place + 8, end)]);
    place = end;
  }
  const [first, ...others] = chunks;
  if (first?.[0] !== jsonChunk) throw corrupt("no JSON chunk at the beginning");
  let json: unknown;
  try {
    json = JSON.parse(new TextDecoder().decode(first[1]));
  } catch {
    throw corrupt("invalid JSON");
  }
  if (!isRecord(json)) throw corrupt(`${describe(json)} as its JSON`);
  return { json, chunks: others };
}

/** Writes a GLB file; each chunk is padded to a multiple of four bytes. */
export function writeGlb({ json, chunks }: { json: object; chunks: readonly GlbChunk[] }): Uint8Array {
  const all: readonly GlbChunk[] = [[jsonChunk, encoded(json)], ...chunks];
  const length = all.reduce((sum, [, content]) => sum + 8 + padded(content.length), 12);
  const file = new Uint8Array(length);
  const view = new DataView(file.buffer);
  [magic, 2, length].forEach((word, i) => {
    view.setUint32(4 * i, word, true);
  });
  let place = 12;
  for (const [type, content] of all) {
    const end = place + 8 + padded(content.length);
    view.setUint32(place, padded(content.length), true);
    view.setUint32(place + 4, type, true);
    // JSON is padded with spaces, other chunks with zeros.
    if (type === jsonChunk) file.fill(0x20, place + 8, end);
    file.set(content, place + 8);
    place = end;
  }
  return file;
}

/** The next multiple of four. */
export const padded = (length: number): number => Math.ceil(length / 4) * 4;

/** JSON as bytes. What callers add to it, metrics and names, may be anything. */
function encoded(json: unknown): Uint8Array {
  try {
    return new TextEncoder().encode(JSON.stringify(json));
  } catch {
    const found = "a value that JSON cannot hold";
    throw failure("INVALID_ARGUMENT", "options.metrics", found, "metrics as in a result", "Pass those of a result.");
  }
}
