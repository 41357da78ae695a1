/** The bytes of files that are passed to conversions. */

import { checkAttached } from "../values/border.js";
import { isBuffer, isTypedArray } from "../values/kinds.js";
import { wrongKind } from "../values/values.js";

/** The bytes of a file, not copied. */
export function bytesOfFile(argument: string, file: unknown, expected: string): Uint8Array {
  if (isBuffer(file) || isTypedArray(file, "Uint8Array")) checkAttached(argument, file);
  if (isBuffer(file)) return new Uint8Array(file);
  if (isTypedArray<Uint8Array>(file, "Uint8Array")) return file;
  throw wrongKind(argument, file, expected, "Uint8Array");
}
