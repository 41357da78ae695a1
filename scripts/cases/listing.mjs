/**
 * The listing of a dataset on its host: revision, licence, and the size and SHA-256 of each archive. The first listing is kept
 * in a lock file, so that later downloads return the same bytes or fail.
 */
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { failure } from "./failure.mjs";

/** The host of the BOP datasets; `HF_ENDPOINT` names a mirror, as for the host's own tools. */
export const defaultHost = process.env.HF_ENDPOINT ?? "https://huggingface.co";

/**
 * @typedef {object} Archive
 * @property {string} address
 * @property {number | null} bytes
 * @property {string | null} sha256 `null` where the host states none; then the first download's is kept
 */

/**
 * @typedef {object} Listing
 * @property {string} dataset
 * @property {string} page for people
 * @property {string} revision
 * @property {string | null} licence as the host names it
 * @property {Record<string, Archive>} archives by name
 */

/**
 * The listing in the lock file, or else the host's, which the lock file then holds.
 * @param {string} lock
 * @param {string} host
 * @param {string} dataset
 * @param {readonly string[]} names of the archives that are needed
 * @returns {Promise<Listing>}
 */
export async function lockedListing(lock, host, dataset, names) {
  if (existsSync(lock)) {
    /** @type {Listing} */
    const kept = JSON.parse(readFileSync(lock, "utf8"));
    if (names.every((name) => name in kept.archives)) return kept;
  }
  const listing = await fetchListing(host, dataset, names);
  writeLock(lock, listing);
  return listing;
}

/** @param {string} lock @param {Listing} listing */
export function writeLock(lock, listing) {
  mkdirSync(dirname(lock), { recursive: true });
  writeFileSync(lock, `${JSON.stringify(listing, null, 2)}\n`);
}

/**
 * @param {string} host
 * @param {string} dataset
 * @param {readonly string[]} names
 * @returns {Promise<Listing>}
 */
async function fetchListing(host, dataset, names) {
  const repository = `datasets/bop-benchmark/${dataset}`;
  const address = `${host}/api/${repository}?blobs=true`;
  const json = await fetchJson(address);
  const { sha, siblings, tags = [] } = json ?? {};
  if (typeof sha !== "string" || !Array.isArray(siblings)) {
    const remedy = "check the address; the host may have changed its interface";
    throw failure("NOT_AVAILABLE", address, "another answer", "{ sha, siblings }", remedy);
  }
  const licence = tags.find((/** @type {unknown} */ tag) => typeof tag === "string" && tag.startsWith("license:"));
  /** @type {Record<string, Archive>} */
  const archives = {};
  for (const name of names) {
    const file = siblings.find(({ rfilename }) => rfilename === name);
    if (file === undefined) {
      const remedy = `see which archives it has, ${host}/${repository}, and download them yourself for --from`;
      throw failure("NOT_AVAILABLE", address, `no ${name}`, "the archives of the dataset", remedy);
    }
    archives[name] = {
      // Of this revision: another upload with the same name is another file.
      address: `${host}/${repository}/resolve/${sha}/${name}`,
      bytes: file.lfs?.size ?? file.size ?? null,
      sha256: file.lfs?.sha256 ?? null,
    };
  }
  const page = `${host}/${repository}`;
  return { dataset, page, revision: sha, licence: licence?.slice("license:".length) ?? null, archives };
}

/** @param {string} address @returns {Promise<any>} */
async function fetchJson(address) {
  const remedy = "check the network; or download the archives elsewhere and name the unpacked folder with --from";
  try {
    const response = await fetch(address);
    if (response.ok) return await response.json();
    throw failure("NOT_AVAILABLE", address, `status ${response.status}`, "a listing of files", remedy);
  } catch (cause) {
    if (cause instanceof Error && "code" in cause && cause.code === "NOT_AVAILABLE") throw cause;
    throw failure("NOT_AVAILABLE", address, "no answer", "a listing of files", remedy, cause);
  }
}
