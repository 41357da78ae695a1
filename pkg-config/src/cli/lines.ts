/** Lines of large files, one after the other. */
import { createReadStream } from "node:fs";

const NEWLINE = 0x0a;

/** The longest line, bytes: longer than any entry, and shorter than the longest string. */
const LONGEST = 1 << 28;

/** A line without its break. */
export interface Line {
  bytes: Buffer;
  /** Its first byte in the file. */
  start: number;
  /** From 1. */
  number: number;
  /** Whether a line break ends it: the last line of a file may have none. */
  isEnded: boolean;
}

/**
 * The lines of a file.
 * @param tooLong the error for a line that is too long
 */
export async function* linesIn(
  path: string,
  tooLong: (problem: string) => Error,
): AsyncGenerator<Line, void, undefined> {
  let [start, length, number] = [0, 0, 1];
  let parts: Buffer[] = [];
  const add = (part: Buffer) => {
    parts.push(part);
    length += part.length;
    if (length > LONGEST) throw tooLong(`line ${number} has more than ${LONGEST} bytes`);
  };
  const line = (isEnded: boolean): Line => ({ bytes: Buffer.concat(parts), start, number, isEnded });

  for await (const chunk of createReadStream(path, { highWaterMark: 1 << 20 }) as AsyncIterable<Buffer>) {
    let from = 0;
    for (let to = chunk.indexOf(NEWLINE); to >= 0; to = chunk.indexOf(NEWLINE, from)) {
      add(chunk.subarray(from, to));
      yield line(true);
      [start, length, number, parts] = [start + length + 1, 0, number + 1, []];
      from = to + 1;
    }
    add(chunk.subarray(from));
  }
  if (length > 0) yield line(false);
}
