/** Reads streams in slices of the main thread's time, so that the page answers meanwhile. */

/** Time without a pause: half a frame. */
const SLICE_MS = 8;

/** Deflate makes at most 1032 bytes of one, and the browser inflates a piece without a pause: at most 2 MB. */
const PIECE_BYTES = 2048;

/** When the last pause ended. */
let resumed = 0;

/** Lets the page answer if the slice is over. Not a timer, which pages in the background may set once a second only. */
async function pause(): Promise<void> {
  if (performance.now() - resumed < SLICE_MS) return;
  await new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = resolve;
    port2.postMessage(null);
    port2.close();
  });
  resumed = performance.now();
}

/** A stream of bytes. */
export function streamOf(bytes: Uint8Array<ArrayBuffer>): ReadableStream<Uint8Array<ArrayBuffer>> {
  let at = 0;
  return new ReadableStream({
    async pull(controller) {
      await pause();
      if (at < bytes.length) controller.enqueue(bytes.subarray(at, at + PIECE_BYTES));
      else controller.close();
      at += PIECE_BYTES;
    },
  });
}

/** The content of a stream; `take` is told the size of each part, and throws where that is too much. */
export async function gathered(
  stream: ReadableStream<Uint8Array>,
  take: (length: number) => void,
): Promise<Uint8Array<ArrayBuffer>> {
  const reader = stream.getReader();
  const parts: Uint8Array[] = [];
  let length = 0;
  try {
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      take(part.value.length);
      length += part.value.length;
      parts.push(part.value);
    }
  } catch (cause) {
    // Of a stream that has failed, this fails as well.
    reader.cancel().catch(() => {});
    throw cause;
  }
  const content = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    await pause();
    content.set(part, at);
    at += part.length;
  }
  return content;
}
