/** What happens before a signal ends the program. */

const signals = ["SIGINT", "SIGTERM"] as const;

/** Calls `act` when the program is interrupted, before it ends; until the returned function is called. */
export function onInterruption(act: () => void): () => void {
  const stop = () => {
    for (const signal of signals) process.off(signal, end);
  };
  const end = (signal: NodeJS.Signals) => {
    stop();
    act();
    // Ends the program as the signal would have: a shell that runs a list of commands stops, too.
    process.kill(process.pid, signal);
  };
  for (const signal of signals) process.on(signal, end);
  return stop;
}
