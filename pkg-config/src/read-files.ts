/** Reading of files (Node only), with the checksums of what a piece of work has read. */
import { AsyncLocalStorage } from "node:async_hooks";
import { createHash } from "node:crypto";
import { readFile, stat } from "node:fs/promises";
import { resolve } from "node:path";
import { fileNotFound } from "./case-files.js";
import { failure, Sim3AlignError } from "./values/error.js";
import { oncePerKey } from "./values/validation.js";

/** The largest file that the readers take, bytes. */
const LARGEST = 2 ** 30;

/** Checksums of files by their absolute paths. */
export type Checksums = Map<string, string>;

const checksums = new AsyncLocalStorage<Checksums>();

/** Does work, and adds the checksums of the files that it reads. */
export const withChecksums = <T>(read: Checksums, work: () => Promise<T>): Promise<T> => checksums.run(read, work);

/** As `oncePerKey`; each caller counts as having read the files. */
export function readOncePerKey<K, T>(load: (key: K) => Promise<T>): (key: K) => Promise<T> {
  const loaded = oncePerKey(async (key: K) => {
    const read: Checksums = new Map();
    return { read, value: await withChecksums(read, () => load(key)) };
  });
  return async (key) => {
    const { read, value } = await loaded(key);
    for (const [path, checksum] of read) checksums.getStore()?.set(path, checksum);
    return value;
  };
}

/** The checksum of bytes. */
export const checksumOf = (bytes: Uint8Array | string): string =>
  createHash("sha256").update(bytes).digest("hex").slice(0, 32);

/** The bytes of a file. Pipes and devices, which may have no end, are not read. */
export async function read(argument: string, path: string): Promise<Uint8Array> {
  try {
    const file = await stat(path);
    if (!file.isFile()) throw fileNotFound(argument, `no ordinary file at ${path}`, "a readable file");
    if (file.size > LARGEST) {
      const remedy = "Crop the image to the object, or simplify the mesh.";
      throw failure("FILE_TOO_LARGE", argument, `${file.size} bytes at ${path}`, `at most ${LARGEST}`, remedy);
    }
    const bytes = await readFile(path);
    checksums.getStore()?.set(resolve(path), checksumOf(bytes));
    return bytes;
  } catch (cause) {
    throw cause instanceof Sim3AlignError ? cause : unreadable(argument, path, "a readable file", cause);
  }
}

/** The error for a file or a folder that cannot be read. */
export function unreadable(argument: string, path: string, expected: string, cause: unknown) {
  const isMissing = cause instanceof Error && "code" in cause && cause.code === "ENOENT";
  const reason = cause instanceof Error && "code" in cause && !isMissing ? ` (${cause.code})` : "";
  return fileNotFound(argument, `nothing to read at ${path}${reason}`, expected, cause);
}
