/** Bold, dim and coloured text, if the terminal supports it and NO_COLOR is not set. */
import type { WriteStream } from "node:tty";

/** Text style of a stream. */
export class Style {
  readonly #isColoured: boolean;

  constructor(stream: Pick<WriteStream, "isTTY">) {
    this.#isColoured = Boolean(stream.isTTY) && !process.env.NO_COLOR && process.env.TERM !== "dumb";
  }

  bold = (text: string): string => this.#wrap(1, 22, text);
  dim = (text: string): string => this.#wrap(2, 22, text);
  red = (text: string): string => this.#wrap(31, 39, text);
  yellow = (text: string): string => this.#wrap(33, 39, text);

  #wrap(open: number, close: number, text: string): string {
    return this.#isColoured ? `\u001b[${open}m${text}\u001b[${close}m` : text;
  }
}
