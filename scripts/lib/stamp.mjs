/** Content stamps: whether a step's inputs are those of its last success. */
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";
import { repository } from "./paths.mjs";

/**
 * All files below the given files and folders, sorted, so that the order is the same everywhere. What does not exist
 * is left out.
 * @param {readonly string[]} paths
 * @returns {string[]}
 */
export function filesBelow(paths) {
  return paths.flatMap((path) => {
    if (!existsSync(path)) return [];
    if (!statSync(path).isDirectory()) return [path];
    return filesBelow(
      readdirSync(path)
        .sort()
        .map((name) => join(path, name)),
    );
  });
}

/**
 * A digest of files (names and contents) and of facts such as versions.
 * @param {readonly string[]} paths files and folders
 * @param {readonly string[]} [facts]
 */
export function digest(paths, facts = []) {
  const hash = createHash("sha256");
  for (const fact of facts) hash.update(`fact ${fact}\n`);
  for (const file of filesBelow(paths)) {
    const content = readFileSync(file);
    hash.update(`file ${relative(repository, file)} ${content.length}\n`).update(content);
  }
  return hash.digest("hex");
}

/** The record, in a file, of the inputs that a step last succeeded with. */
export class Stamp {
  /**
   * @param {string} file where the record is kept
   * @param {string} inputs the digest of the inputs as they are now
   * @param {readonly string[]} outputs files without which the step has to be repeated
   */
  constructor(file, inputs, outputs) {
    this.file = file;
    this.inputs = inputs;
    this.outputs = outputs;
  }

  /** Whether the step can be left out. */
  get isCurrent() {
    return (
      existsSync(this.file) &&
      readFileSync(this.file, "utf8") === this.inputs &&
      this.outputs.every((output) => existsSync(output))
    );
  }

  /** Forgets the last success; to be called before outputs are touched. */
  clear() {
    rmSync(this.file, { force: true });
  }

  /** Records a success. */
  write() {
    mkdirSync(dirname(this.file), { recursive: true });
    writeFileSync(this.file, this.inputs);
  }
}
