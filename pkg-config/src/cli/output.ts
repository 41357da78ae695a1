/** Output of the commands. */
import { writeFile } from "node:fs/promises";
import { Style } from "./style.js";

/** Writes tables to stdout and JSON to a file, or only JSON to stdout. */
export class Output {
  readonly #jsonPath: string | undefined;
  readonly #tables: NodeJS.WriteStream;
  /** Text style of the tables. */
  readonly style: Style;

  constructor(jsonPath: string | undefined) {
    this.#jsonPath = jsonPath;
    this.#tables = jsonPath === "-" ? process.stderr : process.stdout;
    this.style = new Style(this.#tables);
  }

  /** Writes human-readable lines. */
  lines(lines: readonly string[]): void {
    this.#tables.write(lines.map((line) => `${line}\n`).join(""));
  }

  /** Writes the JSON, if requested. */
  async json(text: string): Promise<void> {
    if (this.#jsonPath === undefined) return;
    if (this.#jsonPath === "-") process.stdout.write(text);
    else await writeFile(this.#jsonPath, text);
  }
}
