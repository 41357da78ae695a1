/** Masks from run lengths: background, object, background, … */
import { describe, failure } from "../values/error.js";

/**
 * Decodes alternating runs: 0 in the first run, 1 in the second, and so on.
 * @param count the required sum of the runs
 */
export function filledRuns(argument: string, runs: readonly unknown[], count: number): Uint8Array {
  const corrupt = (found: string) =>
    failure(
      "CORRUPT_FILE",
      argument,
      found,
      `run lengths that add up to ${count}`,
      "Pass the runs with the size of their image.",
    );
  // Checked before allocation, because the size may be malicious.
  let total = 0;
  for (const run of runs) {
    if (!Number.isSafeInteger(run) || (run as number) < 0) throw corrupt(`${describe(run)} among the runs`);
    total += run as number;
  }
  if (total !== count) throw corrupt(`runs of ${total} pixels in total`);
  const pixels = new Uint8Array(count);
  let start = 0;
  runs.forEach((run, i) => {
    const end = start + (run as number);
    if (i % 2 === 1) pixels.fill(1, start, end);
    start = end;
  });
  return pixels;
}
