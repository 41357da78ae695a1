// Names and functions that producer, workers and collector share.
import { createHash } from "node:crypto";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { Redis } from "ioredis";

export const queueName = "sim3align";
/** A hash in Redis: job id → result as JSON. It is independent of how long the queue keeps its jobs. */
export const resultsKey = "sim3align:results";

const { version } = createRequire(import.meta.url)("sim3align/package.json");

/** @returns {Redis} */
export const connect = () =>
  new Redis(process.env.REDIS_URL ?? "redis://127.0.0.1:6379", { maxRetriesPerRequest: null });

/**
 * Reads the files of a case without decoding them. In a cluster, the folder is on storage that all machines can read.
 * @param {string} folder
 */
export async function readCase(folder) {
  const [depth, mask, cameraFile, mesh] = await Promise.all(
    [["depth.npy", "depth.png"], ["mask.png"], ["camera.json"], ["mesh.glb", "mesh.obj", "mesh.ply"]].map((names) =>
      firstOf(names.map((name) => `${folder}/${name}`)),
    ),
  );
  return { depth, mask, cameraFile, mesh };
}

/** @param {string[]} paths */
async function firstOf([path, ...others]) {
  return readFile(path ?? "").catch((error) => {
    if (others.length === 0) throw error;
    return firstOf(others);
  });
}

/**
 * The id depends on files, options and version only, so a case that is queued twice is aligned once.
 * @param {Awaited<ReturnType<typeof readCase>>} files
 * @param {object} options
 */
export function jobIdOf(files, options) {
  const hash = createHash("sha256").update(JSON.stringify([version, Object.entries(options).sort()]));
  for (const [name, bytes] of Object.entries(files)) hash.update(`${name} ${bytes.length}\n`).update(bytes);
  return hash.digest("hex");
}
