/** Follows abort signals. */

interface Followers {
  acts: Set<(reason: unknown) => void>;
  listener: () => void;
}

const followed = new WeakMap<AbortSignal, Followers>();

/**
 * Calls `act` when the signal aborts, until the returned function is called. Each signal gets one listener for all of its
 * followers: Node warns of a leak where a signal has more than a few.
 */
export function onAbort(signal: AbortSignal, act: (reason: unknown) => void): () => void {
  const { acts, listener } = followed.get(signal) ?? begin(signal);
  // A new function each time, so that the same `act` can follow a signal twice.
  const own = (reason: unknown) => act(reason);
  acts.add(own);
  return () => {
    acts.delete(own);
    if (acts.size > 0 || followed.get(signal)?.acts !== acts) return;
    signal.removeEventListener("abort", listener);
    followed.delete(signal);
  };
}

function begin(signal: AbortSignal): Followers {
  const acts: Followers["acts"] = new Set();
  const listener = () => {
    for (const act of [...acts]) act(signal.reason);
  };
  signal.addEventListener("abort", listener);
  const followers = { acts, listener };
  followed.set(signal, followers);
  return followers;
}
