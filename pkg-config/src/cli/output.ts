/** Where the results go. */
import { writeFile } from "node:fs/promises";
import { Style } from "./style.js";

/** Tables for people on stdout; JSON in a file, or on stdout, which then carries nothing else. */
export class Output {
  readonly #jsonPath: string | undefined;
  readonly #tables: NodeJS.WriteStream;
  /** How to write the tables. */
  readonly style: Style;

  constructor(jsonPath: string | undefined) {
    this.#jsonPath = jsonPath;
    this.#tables = jsonPath === "-" ? process.stderr : process.stdout;
    this.style = new Style(this.#tables);
  }

  /** Writes lines for people. */
  lines(lines: readonly string[]): void {
    this.#tables.write(lines.map((line) => `${line}\n`).join(""));
  }

  /** Writes the results for programs, if they were asked for. */
  async json(text: string): Promise<void> {
    if (this.#jsonPath === undefined) return;
    if (this.#jsonPath === "-") process.stdout.write(text);
    else await writeFile(this.#jsonPath, text);
  }
}
