/** How much the files of one drop or of one address may be: the page holds them in memory. */
import { Sim3AlignError } from "sim3align";

/** A video of 1000 frames with depth, photo, pose, camera and five masks each has 9000 files. */
export const MAX_FILES = 10_000;

/** Of all files together, inflated. With the copies that readers make, a tab has room for little more. */
export const MAX_BYTES = 1e9;

/**
 * An archive that inflates to more than this is refused if it inflates by more than {@link MAX_RATIO}. Deflate shrinks
 * any image of one value a thousandfold, so below this size the ratio says nothing: depth of 12 megapixels has 48 MB at
 * most, and a mask of them 12 MB.
 */
export const RATIO_FROM_BYTES = 250e6;

/** Depth with noise and meshes inflate by less than 10, rendered depth and masks by 30 to 200. */
export const MAX_RATIO = 100;

/** Files of an archive or a folder of files are read from the disk one by one, when they are needed. */
const UNPACK = "Unpack it, and drop the folder of one scene.";

/** What the files of one drop or address have used up. */
export class Allowance {
  #files = 0;
  #bytes = 0;

  /** Counts the files that a source names. */
  addFiles(count: number, source: string): void {
    this.#files += count;
    if (this.#files > MAX_FILES) throw tooMuch(`${this.#files} files with those of ${source}`, `at most ${MAX_FILES}`);
  }

  /** Counts bytes of a source, before they are read where their number is known. */
  addBytes(count: number, source: string): void {
    this.#bytes += count;
    if (this.#bytes > MAX_BYTES)
      throw tooMuch(`${size(this.#bytes)} of files with ${source}`, `at most ${size(MAX_BYTES)}`);
  }

  /** Counts the content of an archive by what its directory declares. */
  addArchive(packed: number, inflated: number, source: string): void {
    this.addBytes(inflated, source);
    if (inflated > RATIO_FROM_BYTES && inflated > MAX_RATIO * packed) {
      const found = `${source}, ${size(packed)} that inflate to ${size(inflated)}`;
      throw tooMuch(found, `above ${size(RATIO_FROM_BYTES)} at most ${MAX_RATIO} times the size of the archive`);
    }
  }
}

const tooMuch = (found: string, expected: string) =>
  new Sim3AlignError({ code: "FILE_TOO_LARGE", argument: "files", found, expected, remedy: UNPACK });

/** A size in bytes as text. */
const size = (bytes: number) => (bytes < 1e9 ? `${(bytes / 1e6).toPrecision(3)} MB` : `${(bytes / 1e9).toFixed(1)} GB`);
