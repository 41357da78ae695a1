/** A progress line, on terminals only. */
import type { Progress } from "../options.js";
import { type LineStream, StatusLine } from "./status-line.js";

/** Shows the progress of several cases. */
export class ProgressLine {
  readonly #line: StatusLine;
  readonly #total: number;
  #index = 0;
  #name = "";

  constructor(stream: LineStream, total: number) {
    this.#line = new StatusLine(stream);
    this.#total = total;
  }

  /** Starts the next case. */
  begin(name: string): void {
    this.#index += 1;
    this.#name = name;
    this.#show("reading");
  }

  /** Updates the progress of the current case. */
  update({ stage, fraction }: Progress): void {
    this.#show(`${String(Math.floor(100 * fraction)).padStart(3)} %  ${stage}`);
  }

  /** Clears the line before other output. */
  clear(): void {
    this.#line.clear();
  }

  #show(state: string): void {
    this.#line.show(`[${this.#index}/${this.#total}] ${this.#name}  ${state}`);
  }
}
