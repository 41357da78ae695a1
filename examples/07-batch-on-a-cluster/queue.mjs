// Names and functions that all programs of this example share.
import { createHash } from "node:crypto";
import { readdir, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { sep } from "node:path";
import { Redis } from "ioredis";

export const queueName = "sim3align";
/** A hash in Redis: job id → result as JSON. It is independent of how long the queue keeps its jobs. */
export const resultsKey = "sim3align:results";
/** A hash in Redis: folder and options as JSON → the id of the last job for them. Folders with equal files share a job. */
export const requestsKey = "sim3align:requests";

const { version } = createRequire(import.meta.url)("sim3align/package.json");

/** A connection that waits for Redis as long as it takes, and sends again what got no answer. */
export function connect() {
  const connection = new Redis(process.env.REDIS_URL ?? "redis://127.0.0.1:6379", { maxRetriesPerRequest: null });
  connection.on("error", report);
  return connection;
}

/** @param {Error & { code?: string }} error of the connection, which is made again, or of a lock that was lost with it */
export const report = ({ code, message }) => console.error("warning:", message || code);

/** Files on which results do not depend: true poses, results, and those of the system. */
const isNoInput = /(^|\/)(\.[^/]*|gt\.json|results?\.[^/]*)$/i;

/** Frames in the order of their numbers: frame_2 comes before frame_10. */
const { compare } = new Intl.Collator("en", { numeric: true });

/**
 * The input files of a folder, relative to it. In a cluster, the folder is on storage that all machines can read.
 * @param {string} folder
 */
export async function inputsIn(folder) {
  const names = await readdir(folder, { recursive: true });
  return names
    .map((name) => name.replaceAll(sep, "/"))
    .filter((name) => /\.[^/]+$/.test(name) && !isNoInput.test(name))
    .sort(compare);
}

/**
 * The kind of a folder by the folders in it: a scene, a video (frame_* or FoundationPose's depth/) or a single case.
 * @param {string[]} names
 * @returns {"case" | "scene" | "video"}
 */
export function kindOf(names) {
  if (names.some((name) => name.startsWith("objects/"))) return "scene";
  if (names.some((name) => /^frame_[^/]*\//.test(name))) return "video";
  const hasDepth = names.some((name) => /^depth\.[^/]+$/i.test(name));
  return !hasDepth && names.some((name) => /^depths?\//i.test(name)) ? "video" : "case";
}

/** The entries of options, whatever their order. @param {object} options */
const sorted = (options) => Object.entries(options).sort();

/** A request: a field of `requestsKey`. @param {string} folder @param {object} options */
export const requestOf = (folder, options) => JSON.stringify([folder, sorted(options)]);

/**
 * The id depends on files, options and version only, so a folder that is queued twice is aligned once. Files are read
 * one after the other: a video may be larger than the memory.
 * @param {string} folder
 * @param {string[]} names
 * @param {object} options
 */
export async function jobIdOf(folder, names, options) {
  const hash = createHash("sha256").update(JSON.stringify([version, sorted(options)]));
  for (const name of names) {
    const bytes = await readFile(`${folder}/${name}`);
    hash.update(`${name} ${bytes.length}\n`).update(bytes);
  }
  return hash.digest("hex");
}
