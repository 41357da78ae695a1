/** Following abort signals. */

interface Followers {
  acts: Set<(reason: unknown) => void>;
  listener: () => void;
}

const followed = new WeakMap<AbortSignal, Followers>();

/**
 * Calls `act` when the signal aborts, until the returned function is called. However many follow a signal, it has one
 * listener: of more than a few, Node thinks that they were forgotten.
 */
export function onAbort(signal: AbortSignal, act: (reason: unknown) => void): () => void {
  const { acts, listener } = followed.get(signal) ?? begin(signal);
  // A function of its own, so that following twice is following twice.
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
