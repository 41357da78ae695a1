/** Checks of errors. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type ErrorCode, Sim3AlignError } from "sim3align";

/** The code of an error, and the argument that it is about: `WRONG_LENGTH mesh.positions`. */
export type Fault = `${ErrorCode} ${string}`;

/** Values that must be refused, with the fault and what the message has to say, by default any text. */
export type Refusals<T> = readonly (readonly [value: T, fault: Fault, message?: RegExp])[];

/** Checks that a call fails with a complete error of this kind, whose message says this beside the argument. */
export async function rejectsWith(call: () => unknown, fault: Fault, message = /./): Promise<void> {
  const error = await (async () => call())().then(
    () => assert.fail(`nothing was thrown; expected ${fault}`),
    (thrown: unknown) => thrown,
  );
  assert.ok(error instanceof Sim3AlignError && error instanceof Error, String(error));
  const { name, code, argument, found, expected, remedy } = error;
  assert.equal(name, "Sim3AlignError");
  assert.equal(`${code} ${argument}`, fault, error.message);
  assert.match(error.message, message);
  assert.equal(error.message, `${argument}: found ${found}, expected ${expected}. ${remedy}`);
  for (const part of [found, expected, remedy]) assert.notEqual(part.trim(), "");
  assert.doesNotMatch(error.message, /undefined|NaN ×|\[object/);
}

/** A call that must be refused, with its fault and words of the message. */
export type Refused = Parameters<typeof rejectsWith>;

/** A test for each value that must be refused. */
export function refuses<T>(refusals: Refusals<T>, call: (value: T) => unknown): void {
  for (const [value, fault, message] of refusals) {
    test(`${fault}, ${message}`, () => rejectsWith(() => call(value), fault, message));
  }
}

/** The codes of warnings. */
export const codesOf = (warnings: readonly { code: string }[]) => warnings.map(({ code }) => code);
