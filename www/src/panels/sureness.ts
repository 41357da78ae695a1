/** What is said of a result, by how sure it is. */
import type { ObjectModel } from "../state/object-model.js";
import { SURE } from "../state/progress.js";

/** A refinement that could go on concerns nobody whose result is sure. */
const isQuiet = (code: string, object: ObjectModel) =>
  code === "NOT_CONVERGED" && (object.precise?.confidence ?? 0) >= SURE;

const all = ({ alignment }: ObjectModel) => alignment.value?.warnings ?? [];

/** The warnings beside the result. */
export const warningsOf = (object: ObjectModel) => all(object).filter(({ code }) => !isQuiet(code, object));

/** The warnings among the details. */
export const quietWarningsOf = (object: ObjectModel) => all(object).filter(({ code }) => isQuiet(code, object));
