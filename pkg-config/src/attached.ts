/** Checks that the memory of arrays is there. */
import { describe, failure, type Sim3AlignError, withoutInput } from "./error.js";
import { isAttached, isBuffer, isRecord } from "./kinds.js";

/**
 * Checks all typed arrays and buffers in an argument, which consists of plain objects and arrays. Detached memory must
 * neither reach the modules, which would trap, nor a worker of Node, which would get no message.
 * @param argument its name in errors
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT`
 */
export function checkAttached(argument: string, value: unknown): void {
  if (ArrayBuffer.isView(value) || isBuffer(value)) {
    if (!isAttached(value)) throw detached(argument, value);
  } else if (isRecord(value) || Array.isArray(value)) {
    for (const [name, inner] of Object.entries(value)) {
      if (typeof inner === "object")
        checkAttached(`${argument}${Array.isArray(value) ? `[${name}]` : `.${name}`}`, inner);
    }
  }
}

function detached(argument: string, value: unknown): Sim3AlignError {
  return failure(
    "INVALID_ARGUMENT",
    withoutInput(argument),
    `${describe(value).replace(/ of 0$/, "")} whose memory is detached: it was moved to another thread, or shrunk`,
    "an array with its memory",
    "After a call with transfer: true, use the arrays in `input` of the result or of the error.",
  );
}
