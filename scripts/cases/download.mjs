/** Downloads: resumed where they stopped, and compared with their checksum. */
import { createHash } from "node:crypto";
import { createReadStream, createWriteStream, existsSync, mkdirSync, renameSync, rmSync, statSync } from "node:fs";
import { dirname } from "node:path";
import { Readable, Transform } from "node:stream";
import { pipeline } from "node:stream/promises";
import { failure } from "./failure.mjs";

/** @typedef {import("./listing.mjs").Archive} Archive */

/**
 * Downloads a file to a path, unless it is there. What an interrupted download has left is continued.
 * @param {Archive} archive
 * @param {string} path
 * @param {(bytes: number) => void} [onBytes] gets the number of bytes that are there, now and then
 * @returns {Promise<string>} the SHA-256 of the file, which is the expected one where one is known
 */
export async function download({ address, bytes, sha256 }, path, onBytes) {
  if (existsSync(path)) return checked(path, path, sha256);
  const part = `${path}.part`;
  mkdirSync(dirname(path), { recursive: true });
  const start = existsSync(part) ? statSync(part).size : 0;
  if (bytes === null || start < bytes) await fetchTo(part, address, start, onBytes);
  const length = statSync(part).size;
  if (bytes !== null && length < bytes) {
    const remedy = "run the command again; it continues there";
    throw failure("INCOMPLETE", address, `${length} bytes`, `${bytes} bytes`, remedy);
  }
  const sum = await checked(part, address, sha256);
  renameSync(part, path);
  return sum;
}

/**
 * @param {string} part
 * @param {string} address
 * @param {number} start bytes that are there
 * @param {((bytes: number) => void) | undefined} onBytes
 */
async function fetchTo(part, address, start, onBytes) {
  const remedy = "check the network and run the command again; it continues there";
  const response = await fetch(address, start > 0 ? { headers: { Range: `bytes=${start}-` } } : {}).catch((cause) => {
    throw failure("NOT_AVAILABLE", address, "no answer", "a file", remedy, cause);
  });
  if (!response.ok || response.body === null) {
    throw failure("NOT_AVAILABLE", address, `status ${response.status}`, "a file", remedy);
  }
  // A server that knows no ranges sends everything again.
  const continues = response.status === 206;
  let there = continues ? start : 0;
  const counted = new Transform({
    transform(chunk, _, done) {
      there += chunk.length;
      onBytes?.(there);
      done(null, chunk);
    },
  });
  const body = Readable.fromWeb(/** @type {import("node:stream/web").ReadableStream} */ (response.body));
  try {
    await pipeline(body, counted, createWriteStream(part, { flags: continues ? "a" : "w" }));
  } catch (cause) {
    throw failure("INCOMPLETE", address, `an end after ${there} bytes`, "the whole file", remedy, cause);
  }
}

/**
 * @param {string} file
 * @param {string} argument
 * @param {string | null} sha256
 */
async function checked(file, argument, sha256) {
  const hash = createHash("sha256");
  await pipeline(createReadStream(file), hash);
  const sum = hash.digest("hex");
  if (sha256 === null || sum === sha256) return sum;
  // The next run must not continue what is wrong from its start.
  rmSync(file);
  const remedy =
    "the file was deleted: run the command again; if it fails again, the host has other bytes than the lock file says, so see what changed there before you delete the lock file";
  throw failure("CHECKSUM_MISMATCH", argument, `SHA-256 ${sum}`, sha256, remedy);
}
