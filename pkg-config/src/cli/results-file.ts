/** The JSON of the results, which is complete after each case: an interruption loses no result. */
import { closeSync, openSync } from "node:fs";
import { checkReplaceable, checkWritable, writeAll, writing } from "./writable.js";

const END = "\n}\n";

/** Whether a file begins as {@link ResultsFile} writes it: the names of cases, and what became of each. */
const isResults = (beginning: string) =>
  /^\{\n {2}"(?:[^"\\]|\\.)*": \{\n {4}"/.test(beginning) || beginning.trim() === "{}" || beginning === `{\n${END}`;

/** An object with an entry for each case, in a file or on stdout. */
export class ResultsFile {
  readonly #path: string;
  /** Whether entries are written as they come. Pipes and devices get all of them at the end. */
  readonly #isIncremental: boolean;
  #entries: string[] = [];
  #file: number | undefined;
  /** Bytes of the file before its end. */
  #length = 0;

  /**
   * Writes nothing yet: a file that exists keeps its content until the first entry.
   * @param path a file; "-" is stdout
   * @throws {@link UsageError} if the file cannot be written
   */
  constructor(path: string) {
    this.#path = path;
    this.#isIncremental = path !== "-" && checkWritable("--json", path);
    if (this.#isIncremental) checkReplaceable("--json", path, isResults);
  }

  /**
   * Adds the entry of a case.
   * @param isFinal whether no other entry will replace it
   */
  add(name: string, entry: object, isFinal = true): void {
    if (!this.#isIncremental && !isFinal) return;
    const text = `  ${JSON.stringify(name)}: ${JSON.stringify(entry, null, 2).replaceAll("\n", "\n  ")}`;
    if (!this.#isIncremental) {
      this.#entries.push(text);
      return;
    }
    const isFirst = this.#length === 0;
    const bytes = Buffer.from(`${isFirst ? "{\n" : ",\n"}${text}${END}`);
    writing(this.#path, () => {
      this.#file ??= openSync(this.#path, "w");
      writeAll(this.#file, bytes, this.#length);
    });
    if (isFinal) this.#length += bytes.length - END.length;
  }

  /** Writes what is not written yet. */
  end(): void {
    if (this.#file !== undefined) closeSync(this.#file);
    this.#file = undefined;
    if (this.#isIncremental) return;
    const text = `{\n${this.#entries.join(",\n")}${END}`;
    this.#entries = [];
    if (this.#path === "-") {
      process.stdout.write(text);
      return;
    }
    writing(this.#path, () => {
      const file = openSync(this.#path, "w");
      try {
        writeAll(file, Buffer.from(text), null);
      } finally {
        closeSync(file);
      }
    });
  }
}
