/** Text on a terminal: styles, and names that cannot control it. */
import type { WriteStream } from "node:tty";

// biome-ignore lint/suspicious/noControlCharactersInRegex: these are what is replaced.
const CONTROLS = /[\u0000-\u001f\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]/g;
// biome-ignore lint/suspicious/noControlCharactersInRegex: the sequences of styles.
const STYLES = /(\u001b\[(?:1|22|31|33|39)m)/;

const escaped = (character: string) =>
  character === "\n" ? "\\n" : `\\u${character.charCodeAt(0).toString(16).padStart(4, "0")}`;

/** A line whose control characters, which names of files may have, are escaped. */
export const printable = (line: string): string => line.replace(CONTROLS, escaped);

/** Prints a line to stderr. */
export const note = (line: string): void => {
  process.stderr.write(`${printable(line)}\n`);
};

/** Bold and coloured text, if the terminal supports it and NO_COLOR is not set. */
export class Style {
  readonly #isColoured: boolean;

  constructor(stream: Pick<WriteStream, "isTTY">) {
    this.#isColoured = Boolean(stream.isTTY) && !process.env.NO_COLOR && process.env.TERM !== "dumb";
  }

  bold = (text: string): string => this.#wrap(1, 22, text);
  red = (text: string): string => this.#wrap(31, 39, text);
  yellow = (text: string): string => this.#wrap(33, 39, text);

  /** A line with escaped control characters, but for those of styles. */
  printable = (line: string): string =>
    this.#isColoured
      ? line
          .split(STYLES)
          .map((text, i) => (i % 2 === 0 ? printable(text) : text))
          .join("")
      : printable(line);

  #wrap(open: number, close: number, text: string): string {
    return this.#isColoured ? `\u001b[${open}m${text}\u001b[${close}m` : text;
  }
}
