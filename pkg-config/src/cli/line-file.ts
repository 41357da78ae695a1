/** Files to which whole lines are appended. */
import { closeSync, openSync } from "node:fs";
import { writeAll, writing } from "./writable.js";

/** A file, pipe or stdout. It is opened when the first line comes: until then, it keeps its content. */
export class LineFile {
  readonly #path: string;
  readonly #mode: "a" | "w";
  #file: number | undefined;

  /**
   * @param path a file; "-" is stdout
   * @param mode whether lines are appended to the file or replace its content
   */
  constructor(path: string, mode: "a" | "w") {
    this.#path = path;
    this.#mode = mode;
  }

  /** Appends lines, in one write: another program that follows the file reads whole ones. */
  append(lines: readonly string[]): void {
    const text = lines.map((line) => `${line}\n`).join("");
    if (this.#path === "-") {
      process.stdout.write(text);
      return;
    }
    writing(this.#path, () => {
      this.#file ??= openSync(this.#path, this.#mode);
      writeAll(this.#file, Buffer.from(text), null);
    });
  }

  end(): void {
    if (this.#file !== undefined) closeSync(this.#file);
    this.#file = undefined;
  }
}
