/** In a worker: lets messages arrive. */

const waiting: (() => void)[] = [];
let port: MessagePort | undefined;

/** Calls back when the messages that were sent to this thread have arrived: unlike a timer, not milliseconds later. */
function callLater(callback: () => void): void {
  // Node would handle a thousand messages of this port before those of another one.
  if (typeof setImmediate === "function") {
    setImmediate(callback);
    return;
  }
  if (port === undefined) {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => waiting.shift()?.();
    port = port2;
  }
  waiting.push(callback);
  port.postMessage(undefined);
}

/** Waits until messages have arrived. */
export const turn = () => new Promise<void>(callLater);
