/** Checks of errors. */
import assert from "node:assert/strict";
import { type ErrorCode, Sim3AlignError } from "sim3align";

/** What an error has to be. */
export interface Expected {
  code: ErrorCode;
  argument: string;
  /** What the message has to say, beside the argument. */
  message: RegExp;
}

/** Checks that a call is rejected with a complete error of this kind. */
export async function rejectsWith(call: () => Promise<unknown>, { code, argument, message }: Expected): Promise<void> {
  const error = await call().then(
    () => assert.fail(`nothing was thrown; expected ${code}`),
    (thrown: unknown) => thrown,
  );
  assert.ok(error instanceof Sim3AlignError && error instanceof Error, String(error));
  assert.equal(error.name, "Sim3AlignError");
  assert.equal(error.code, code, error.message);
  assert.equal(error.argument, argument, error.message);
  assert.match(error.message, message);
  assert.equal(error.message, `${argument}: found ${error.found}, expected ${error.expected}. ${error.remedy}`);
  for (const part of [error.found, error.expected, error.remedy]) assert.notEqual(part.trim(), "");
  assert.doesNotMatch(error.message, /undefined|NaN ×|\[object/);
}
