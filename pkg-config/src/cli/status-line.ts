/** A line that is overwritten. */

const eraseLine = "\r\u001b[2K";

/** The part of a stream that a line needs. */
export type LineStream = Pick<NodeJS.WriteStream, "isTTY" | "columns" | "write">;

/** A line on a terminal; other streams get none. */
export class StatusLine {
  readonly #stream: LineStream;

  constructor(stream: LineStream) {
    this.#stream = stream;
  }

  /** Replaces the line, cut to the width of the terminal. */
  show(text: string): void {
    if (!this.#stream.isTTY) return;
    this.#stream.write(eraseLine + text.slice(0, Math.max(10, (this.#stream.columns || 80) - 1)));
  }

  /** Clears the line before other output. */
  clear(): void {
    if (this.#stream.isTTY) this.#stream.write(eraseLine);
  }
}
