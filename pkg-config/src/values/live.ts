/** Objects that are alive, such as those of three.js and the tensors of transformers.js. */
import { failure, messageOf, Sim3AlignError } from "./error.js";

/**
 * Reads or sets objects that are alive: nothing of them is copied.
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for what they throw, and for what they lack
 */
export function withLive<T>(argument: string, expected: string, work: () => T): T {
  try {
    return work();
  } catch (cause) {
    if (cause instanceof Sim3AlignError) throw cause;
    const found = `what throws ${messageOf(cause)}`;
    throw failure("INVALID_ARGUMENT", argument, found, expected, "Pass the object of its library.", cause);
  }
}
