/** Masks from run lengths: background, object, background, … */
import { describe } from "../error.js";
import { failure } from "../values.js";

/**
 * The pixels of alternating runs: 0 in the first run, 1 in the second, and so on.
 * @param count how many pixels the runs have to sum up to
 */
export function filledRuns(argument: string, runs: readonly unknown[], count: number): Uint8Array {
  const corrupt = (found: string) =>
    failure(
      "CORRUPT_FILE",
      argument,
      found,
      `run lengths that sum up to ${count}`,
      "Pass the runs and their own size.",
    );
  // Checked before the pixels are allocated: sizes in files may be made up.
  let total = 0;
  for (const run of runs) {
    if (!Number.isSafeInteger(run) || (run as number) < 0) throw corrupt(`${describe(run)} among the runs`);
    total += run as number;
  }
  if (total !== count) throw corrupt(`runs of ${total} pixels in all`);
  const pixels = new Uint8Array(count);
  let start = 0;
  runs.forEach((run, i) => {
    const end = start + (run as number);
    if (i % 2 === 1) pixels.fill(1, start, end);
    start = end;
  });
  return pixels;
}
