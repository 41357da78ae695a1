/** Zip archives whose headers say what a test wants, which no program writes. */
import { constants, deflateRawSync } from "node:zlib";
import { crc32 } from "./files.js";

/** A file in an archive, and what its headers say instead of the truth. */
export interface ZipEntry {
  path: string;
  /** Deflated, unless `method` says otherwise. */
  packed: Uint8Array;
  /** The size that the directory declares. */
  inflated: number;
  /** The checksum that the directory declares. */
  crc?: number;
  method?: number;
  flags?: number;
}

/** An entry with this content. */
export const deflated = (path: string, content: Uint8Array): ZipEntry => ({
  path,
  packed: deflateRawSync(content),
  inflated: content.length,
  crc: crc32(content),
});

const BLOCK_BYTES = 1 << 22;

/** Zeros, a multiple of 4 MB, deflated without being made: a flushed block of them follows on another. */
export function zeros(path: string, bytes: number): ZipEntry {
  const block = deflateRawSync(new Uint8Array(BLOCK_BYTES), { finishFlush: constants.Z_FULL_FLUSH });
  const blocks = Array<Uint8Array>(bytes / BLOCK_BYTES).fill(block);
  return { path, packed: Buffer.concat([...blocks, deflateRawSync(new Uint8Array())]), inflated: bytes };
}

/** An archive of the entries; `count` is the number of entries that it declares. */
export function zip(entries: readonly ZipEntry[], count = entries.length): Uint8Array<ArrayBuffer> {
  const parts: Uint8Array[] = [];
  const directory: Uint8Array[] = [];
  let at = 0;
  for (const { path, packed, inflated, crc = 0, method = 8, flags = 0 } of entries) {
    const name = Buffer.from(path);
    const facts = words([20, 2], [flags, 2], [method, 2], [0, 4], [crc, 4], [packed.length, 4], [inflated, 4]);
    const local = Buffer.concat([words([0x04034b50, 4]), facts, words([name.length, 2], [0, 2]), name]);
    const place = words([name.length, 2], [0, 2], [0, 2], [0, 2], [0, 2], [0, 4], [at, 4]);
    directory.push(words([0x02014b50, 4], [20, 2]), facts, place, name);
    parts.push(local, packed);
    at += local.length + packed.length;
  }
  const listed = Buffer.concat(directory);
  const end = words([0x06054b50, 4], [0, 4], [count, 2], [count, 2], [listed.length, 4], [at, 4], [0, 2]);
  return Uint8Array.from(Buffer.concat([...parts, listed, end]));
}

/** Little-endian numbers of some bytes each. */
function words(...numbers: readonly (readonly [value: number, bytes: number])[]): Buffer {
  return Buffer.concat(
    numbers.map(([value, bytes]) => {
      const word = Buffer.alloc(bytes);
      word.writeUIntLE(value, 0, bytes);
      return word;
    }),
  );
}
