/** What is wrong with an input, and which. */
import { Sim3AlignError } from "sim3align";
import type { Field } from "./inputs.js";

/** An error with the field that it belongs beside. */
export class FieldError extends Error {
  readonly field: Field;
  /** What to do about it, where the library says so. */
  readonly remedy: string;
  readonly code: string;

  constructor(field: Field, cause: unknown) {
    const own = cause instanceof Sim3AlignError;
    super(
      own ? `Found ${cause.found}, expected ${cause.expected}.` : cause instanceof Error ? cause.message : `${cause}`,
      {
        cause,
      },
    );
    this.name = "FieldError";
    this.field = field;
    this.remedy = own ? cause.remedy : "";
    this.code = own ? cause.code : "";
  }
}

/** Does something for a field, which its failure is about. */
export async function forField<T>(field: Field, work: () => Promise<T> | T): Promise<T> {
  try {
    return await work();
  } catch (error) {
    throw error instanceof FieldError ? error : new FieldError(field, error);
  }
}

const fields: readonly Field[] = ["depth", "mask", "mesh", "camera", "photo"];

/** The field that an error of `align` is about, or null where it is about none. */
export function fieldOf(error: unknown): Field | null {
  if (!(error instanceof Sim3AlignError)) return null;
  return fields.find((field) => error.argument === field || error.argument.startsWith(`${field}.`)) ?? null;
}
