/** Errors of the input fields. */
import { Sim3AlignError } from "sim3align";
import type { Field } from "./inputs.js";

/** An error with the field that shows it. */
export class FieldError extends Error {
  readonly field: Field;
  /** How to resolve it; empty if unknown. */
  readonly remedy: string;
  readonly code: string;

  constructor(field: Field, cause: unknown) {
    const error = cause instanceof Sim3AlignError ? cause : null;
    const message = cause instanceof Error ? cause.message : `${cause}`;
    super(error === null ? message : `Found ${error.found}, expected ${error.expected}.`, { cause });
    this.name = "FieldError";
    this.field = field;
    this.remedy = error?.remedy ?? "";
    this.code = error?.code ?? "";
  }
}

/** Runs a step of reading a field. Its errors become those of the field. */
export async function forField<T>(field: Field, work: () => Promise<T> | T): Promise<T> {
  try {
    return await work();
  } catch (error) {
    throw error instanceof FieldError ? error : new FieldError(field, error);
  }
}

const fields: readonly Field[] = ["depth", "mask", "mesh", "camera", "photo"];

/** The field that an error of `align` concerns, or null. */
export function fieldOf(error: unknown): Field | null {
  if (!(error instanceof Sim3AlignError)) return null;
  return fields.find((field) => error.argument === field || error.argument.startsWith(`${field}.`)) ?? null;
}
