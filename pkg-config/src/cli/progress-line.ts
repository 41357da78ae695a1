/** A progress line, on terminals only. */
import type { Progress } from "../options.js";

const eraseLine = "\r\u001b[2K";

/** Shows the progress of several cases. */
export class ProgressLine {
  readonly #stream: NodeJS.WriteStream;
  readonly #total: number;
  #index = 0;
  #name = "";

  constructor(stream: NodeJS.WriteStream, total: number) {
    this.#stream = stream;
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
    if (this.#stream.isTTY) this.#stream.write(eraseLine);
  }

  #show(state: string): void {
    if (!this.#stream.isTTY) return;
    const line = `[${this.#index}/${this.#total}] ${this.#name}  ${state}`;
    this.#stream.write(eraseLine + line.slice(0, Math.max(10, (this.#stream.columns || 80) - 1)));
  }
}
