/** Members of zip archives. Only those that are asked for are unpacked. */
import { createWriteStream, existsSync, mkdirSync, renameSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { pipeline } from "node:stream/promises";
import { failure } from "./failure.mjs";

/** Several archives as one folder. A leading folder of the dataset's name, which some have, is left out. */
export class Archives {
  /** @type {Map<string, { zip: import("yauzl").ZipFile, entry: import("yauzl").Entry }>} */
  #members = new Map();
  /** @type {import("yauzl").ZipFile[]} */
  #open = [];

  /**
   * @param {string} dataset
   * @param {readonly string[]} files
   */
  static async of(dataset, files) {
    // The set-up installs it first.
    const { openPromise } = (await import("yauzl")).default;
    const archives = new Archives();
    for (const file of files) {
      try {
        const zip = await openPromise(file, { autoClose: false });
        archives.#open.push(zip);
        for await (const entry of zip.eachEntry()) {
          const path = entry.fileName.replace(new RegExp(`^${dataset}/`), "");
          if (!path.endsWith("/")) archives.#members.set(path, { zip, entry });
        }
      } catch (cause) {
        archives.close();
        const found = cause instanceof Error ? cause.message : `${cause}`;
        throw failure("CORRUPT_FILE", basename(file), found, "a zip archive", "delete it and download it again", cause);
      }
    }
    return archives;
  }

  get paths() {
    return [...this.#members.keys()];
  }

  /**
   * Unpacks members into a folder, by their paths; those that are there stay.
   * @param {string} folder
   * @param {Iterable<string>} paths
   */
  async extract(folder, paths) {
    for (const path of paths) {
      const to = join(folder, path);
      if (existsSync(to)) continue;
      const member = this.#members.get(path);
      if (member === undefined) {
        throw failure("CORRUPT_FILE", path, "no such member", "a member of the archives", "see what the archives hold");
      }
      mkdirSync(dirname(to), { recursive: true });
      try {
        await pipeline(await member.zip.openReadStreamPromise(member.entry), createWriteStream(`${to}.part`));
      } catch (cause) {
        const found = cause instanceof Error ? cause.message : `${cause}`;
        throw failure("CORRUPT_FILE", path, found, "a whole member", "delete the archive, download it again", cause);
      }
      renameSync(`${to}.part`, to);
    }
  }

  close() {
    for (const zip of this.#open) zip.close();
  }
}
