/** Output of the commands. */
import { ResultsFile } from "./results-file.js";
import { Style } from "./style.js";

/** Writes tables to stdout and JSON to a file, or only JSON to stdout. */
export class Output {
  /** The JSON, if requested. */
  readonly results: ResultsFile | undefined;
  readonly #tables: NodeJS.WriteStream;
  /** Text style of the tables. */
  readonly style: Style;
  #isClosed = false;

  /** @throws {@link UsageError} if the JSON cannot be written */
  constructor(jsonPath: string | undefined) {
    this.results = jsonPath === undefined ? undefined : new ResultsFile(jsonPath);
    this.#tables = jsonPath === "-" ? process.stderr : process.stdout;
    this.style = new Style(this.#tables);
    this.#tables.on("error", () => {
      this.#isClosed = true;
    });
  }

  /** Whether nothing will be read any more: "| head" has ended, and there is no JSON. */
  get isClosed(): boolean {
    return this.#isClosed && this.results === undefined;
  }

  /** Writes human-readable lines. */
  lines(lines: readonly string[]): void {
    this.#tables.write(lines.map((line) => `${line}\n`).join(""));
  }
}
