/**
 * The fuzzer of the package: odd calls without and with workers, storms of a pool, calls side by side without workers, and
 * odd calls of the conventions. Each execution has a seed.
 */
import assert from "node:assert/strict";
import { type Aligner, createAligner } from "sim3align";
import { Random } from "../random.js";
import { withoutTimes } from "../results.js";
import { input } from "../scene.js";
import { checkError, type Outcome, outcomeOf, randomCall } from "./calls.js";
import { conventionCall } from "./conventions.js";
import { sideBySide } from "./side-by-side.js";
import { storm } from "./storm.js";

/** A kind of execution: what it does with a seed, and how many calls that were. */
export type Target = (seed: number) => Promise<number>;

/** Longest that a call may take, milliseconds: a call beyond it hangs. */
const HANGS_MS = 60_000;

/** Creates the targets, by name. */
export async function targets() {
  const [here, pool] = await Promise.all([0, 1].map((workers) => createAligner({ workers })));
  const aligners = [here, pool] as [Aligner, Aligner];
  const bits = async (aligner: Aligner) => withoutTimes(await aligner.align(input, { quality: "fast" }));
  const expected = await bits(aligners[0]);
  const unhandled: unknown[] = [];
  const note = (error: unknown) => unhandled.push(error);
  process.on("unhandledRejection", note);
  let executions = 0;

  const guarded = async (name: string, seed: number, run: () => Promise<number>) => {
    try {
      const count = await settled(run());
      assert.deepEqual(unhandled, [], "an unhandled rejection");
      return count;
    } catch (error) {
      throw new Error(`${name}, seed ${seed}: ${(error as Error).message}`, { cause: error });
    }
  };

  return {
    calls: (seed: number) =>
      guarded("calls", seed, async () => {
        const outcomes: Outcome[] = [];
        for (const aligner of aligners) {
          // The arguments are made anew: calls may change and move them.
          const outcome = await outcomeOf(randomCall(aligner, new Random(seed)));
          if ("error" in outcome) checkError(outcome.error);
          outcomes.push(outcome);
        }
        const [own, other] = outcomes.map(described);
        assert.equal(other, own, "another outcome in a worker");
        executions += 1;
        if (executions % 100 === 0) {
          for (const aligner of aligners) assert.deepEqual(await bits(aligner), expected, "other bits afterwards");
        }
        return 2;
      }),
    storms: (seed: number) => guarded("storms", seed, () => storm(new Random(seed))),
    sideBySide: (seed: number) => guarded("side by side", seed, () => sideBySide(new Random(seed))),
    conventions: (seed: number) =>
      guarded("conventions", seed, async () => {
        const { name, call } = conventionCall(new Random(seed));
        try {
          // Not awaited: the result may hold a `then` of the caller.
          call();
        } catch (thrown) {
          try {
            checkError(thrown);
          } catch (error) {
            throw new Error(`${name}: ${(error as Error).message}`, { cause: (error as Error).cause ?? error });
          }
        }
        return 1;
      }),
    /** Checks that nothing was left behind, and ends the workers. */
    async end() {
      for (const aligner of aligners) assert.deepEqual(await bits(aligner), expected, "other bits afterwards");
      for (const aligner of aligners) aligner.dispose();
      process.off("unhandledRejection", note);
    },
  };
}

/** An outcome in words: the same with workers and without. */
function described(outcome: Outcome): string {
  if ("result" in outcome) return "a result";
  const { code, argument, message } = outcome.error as { code?: string; argument?: string; message: string };
  return code === undefined ? message : `${code} ${argument}`;
}

async function settled<T>(call: Promise<T>): Promise<T> {
  let timer: NodeJS.Timeout | undefined;
  const late = new Promise<never>((_, reject) => {
    timer = setTimeout(() => reject(new Error("a call that does not settle")), HANGS_MS);
  });
  try {
    return await Promise.race([call, late]);
  } finally {
    clearTimeout(timer);
  }
}
