/** Inputs that must be refused: what is changed in a good one. */
import assert from "node:assert/strict";
import { after } from "node:test";
import { type AlignInput, createAligner } from "sim3align";
import { type Refusals, refuses } from "./errors.js";
import { input, truth } from "./scene.js";

/** The aligner of a test file: when all tests are done, it must still work. */
export const aligner = await createAligner();

const reference = (await aligner.evaluate(input, truth)).metrics;
after(async () => {
  assert.deepEqual((await aligner.evaluate(input, truth)).metrics, reference, "after all that, the aligner works on");
});

/** One test for each change that makes an input bad. */
export const refusesInputs = (changes: Refusals<object>) =>
  refuses(changes, (change) => aligner.align({ ...input, ...change } as AlignInput));

/** An array with another value at an index. */
export function changed<T extends { slice(): T; [index: number]: number }>(array: T, index: number, value: number): T {
  const copy = array.slice();
  copy[index] = value;
  return copy;
}
