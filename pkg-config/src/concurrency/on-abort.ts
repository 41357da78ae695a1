/** Abort signals: callbacks, and checks. */
import type { SignalLike } from "../types/platform.js";

interface Followers {
  acts: Set<(reason: unknown) => void>;
  listener: () => void;
}

const followed = new WeakMap<SignalLike, Followers>();

/**
 * Calls `act` when the signal aborts, until the returned function is called. A signal gets one listener regardless of
 * the number of callbacks, because Node warns of a leak if there are many.
 */
export function onAbort(signal: SignalLike, act: (reason: unknown) => void): () => void {
  const { acts, listener } = followed.get(signal) ?? begin(signal);
  // Wraps `act`, so that registering it twice calls it twice.
  const own = (reason: unknown) => act(reason);
  acts.add(own);
  return () => {
    acts.delete(own);
    if (acts.size > 0 || followed.get(signal)?.acts !== acts) return;
    signal.removeEventListener("abort", listener);
    followed.delete(signal);
  };
}

/** {@link onAbort} of several signals. */
export function onAnyAbort(signals: readonly SignalLike[], act: (reason: unknown) => void): () => void {
  const unfollow = signals.map((signal) => onAbort(signal, act));
  return () => {
    for (const end of unfollow) end();
  };
}

function begin(signal: SignalLike): Followers {
  const acts: Followers["acts"] = new Set();
  const listener = () => {
    for (const act of [...acts]) act(reasonOf(signal));
  };
  signal.addEventListener("abort", listener);
  const followers = { acts, listener };
  followed.set(signal, followers);
  return followers;
}

/** Throws the reason of an aborted signal. Not `throwIfAborted`, which older implementations lack. */
export function checkSignals(signals: readonly SignalLike[]): void {
  for (const signal of signals) if (signal.aborted) throw reasonOf(signal);
}

/** The value of a promise, unless a signal aborts before: then its reason is thrown. */
export async function beforeAbort<T>(awaited: Promise<T>, signals: readonly SignalLike[]): Promise<T> {
  let unfollow = () => {};
  const aborted = new Promise<never>((_, reject) => {
    unfollow = onAnyAbort(signals, reject);
  });
  try {
    return await Promise.race([awaited, aborted]);
  } finally {
    unfollow();
  }
}

const missingReasons = new WeakMap<SignalLike, DOMException>();

/** The reason of an aborted signal. Signals of older implementations have none: they get one, always the same. */
export function reasonOf(signal: SignalLike): unknown {
  if (signal.reason !== undefined) return signal.reason;
  const reason = missingReasons.get(signal) ?? new DOMException("This operation was aborted", "AbortError");
  missingReasons.set(signal, reason);
  return reason;
}
