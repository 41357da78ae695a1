import { useEffect, useState } from "react";
import { createAligner } from "sim3align";

/** One pool of workers for the whole app. It is made by the first effect, so never on the server. */
let shared;
const aligner = () => {
  shared ??= createAligner({ workers: "auto" });
  return shared;
};

const idle = { state: "idle", fraction: 0 };

/**
 * Aligns an input in workers, and again whenever the input or the options are others. What runs is cancelled when the
 * component goes, or its input changes.
 * @param input of `align`; null for none yet. Keep the object for as long as the input is the same
 * @param options of `align`; keep the object as well
 * @returns `{ state: "idle" | "running" | "done" | "failed", fraction, result?, error? }`
 */
export function useAlignment(input, options) {
  const [run, setRun] = useState(idle);
  useEffect(() => {
    if (input === null) return;
    const cancel = new AbortController();
    const { signal } = cancel;
    // A call that was cancelled says nothing: its component may be gone.
    const say = (next) => signal.aborted || setRun(next);
    say({ state: "running", fraction: 0 });
    aligner()
      .then((ready) =>
        ready.align(input, {
          ...options,
          signal,
          onProgress: ({ fraction }) => say({ state: "running", fraction }),
        }),
      )
      .then(
        (result) => say({ state: "done", fraction: 1, result }),
        (error) => say({ state: "failed", fraction: 0, error }),
      );
    return () => cancel.abort();
  }, [input, options]);
  return run;
}
