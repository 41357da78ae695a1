/** Reads large files outside of the main thread. */
import { Sim3AlignError } from "sim3align";
import { readDepth, readMask, readMesh } from "sim3align/formats";

const readers = { readDepth, readMask, readMesh };

export type Readers = typeof readers;

/** A call of a reader. */
export interface ReaderCall {
  id: number;
  name: keyof Readers;
  parameters: readonly unknown[];
}

/** The fields of a `Sim3AlignError`, or the message of another error. */
export type ReaderError = Pick<Sim3AlignError, "code" | "argument" | "found" | "expected" | "remedy"> | string;

export type ReaderAnswer = { id: number; value: unknown } | { id: number; error: ReaderError };

function plainError(cause: unknown): ReaderError {
  if (!(cause instanceof Sim3AlignError)) return cause instanceof Error ? cause.message : `${cause}`;
  const { code, argument, found, expected, remedy } = cause;
  return { code, argument, found, expected, remedy };
}

/** The buffers of a value of a reader, which are transferred instead of copied. */
function buffersOf(value: unknown): ArrayBuffer[] {
  if (ArrayBuffer.isView(value)) return [value.buffer as ArrayBuffer];
  return typeof value === "object" && value !== null ? Object.values(value).flatMap(buffersOf) : [];
}

addEventListener("message", async ({ data: { id, name, parameters } }: MessageEvent<ReaderCall>) => {
  try {
    const value: unknown = await (readers[name] as (...parameters: readonly unknown[]) => Promise<unknown>)(
      ...parameters,
    );
    const answer: ReaderAnswer = { id, value };
    postMessage(answer, { transfer: [...new Set(buffersOf(value))] });
  } catch (cause) {
    const answer: ReaderAnswer = { id, error: plainError(cause) };
    postMessage(answer);
  }
});
