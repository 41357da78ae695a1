/** Reads objects of other libraries, such as those of three.js and the tensors of transformers.js, without copying them. */
import { failure, messageOf, Sim3AlignError } from "./error.js";

/**
 * Reads or changes an object of another library.
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for what they throw, and for what they lack
 */
export function withForeignObject<T>(argument: string, expected: string, work: () => T): T {
  try {
    return work();
  } catch (cause) {
    if (cause instanceof Sim3AlignError) throw cause;
    const found = `what throws ${messageOf(cause)}`;
    throw failure("INVALID_ARGUMENT", argument, found, expected, "Pass the object of its library.", cause);
  }
}
