/** Inputs that must be refused: what is changed in a good one, and the error that it gets. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, createAligner, type ErrorCode } from "sim3align";
import { rejectsWith } from "./errors.js";
import { input, truth } from "./scene.js";

/** A case: what is changed in a good input, and the error that it gets. */
export type Bad = [name: string, change: object, code: ErrorCode, argument: string, message: RegExp];

/** The aligner of a test file: when all tests are done, it must still work. */
export const aligner = await createAligner();
const reference = (await aligner.evaluate(input, truth)).metrics;
after(async () => {
  assert.deepEqual((await aligner.evaluate(input, truth)).metrics, reference, "after all that, the aligner works on");
});

/** One test for each bad input. */
export function refuses(cases: readonly Bad[]): void {
  for (const [name, change, code, argument, message] of cases) {
    const call = () => aligner.align({ ...input, ...change } as AlignInput);
    test(`${name}: ${code}`, () => rejectsWith(call, { code, argument, message }));
  }
}

/** An array with another value at an index. */
export function changed<T extends { slice(): T; [index: number]: number }>(array: T, index: number, value: number): T {
  const copy = array.slice();
  copy[index] = value;
  return copy;
}
