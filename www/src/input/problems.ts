/** What is wrong with an input, the field that says so, and what helps. */
import { type ErrorCode, Sim3AlignError } from "sim3align";
import type { Field, Inputs } from "../state/inputs.js";

/** A change of the inputs that resolves a problem. */
export interface Remedy {
  title: string;
  apply(inputs: Inputs): Inputs;
}

/** A problem of a field. */
export interface Problem {
  field: Field;
  /** The index of the object, for masks and meshes. */
  object?: number;
  message: string;
  /** Errors have to be resolved; doubts only have to be seen. */
  kind: "error" | "doubt";
  remedies: readonly Remedy[];
  /** The code of the reader's error. */
  code?: ErrorCode;
}

export const error = (field: Field, message: string, remedies: readonly Remedy[] = [], object?: number): Problem => ({
  ...{ field, message, kind: "error", remedies },
  ...(object === undefined ? {} : { object }),
});

export const doubt = (field: Field, message: string, remedies: readonly Remedy[] = [], object?: number): Problem => ({
  ...error(field, message, remedies, object),
  kind: "doubt",
});

/** The problem that an error of a reader is; `source` is what it has read. */
export const errorOf = (field: Field, cause: unknown, object?: number, source?: string): Problem => ({
  ...error(field, source === undefined ? messageOf(cause) : `${source}: ${messageOf(cause)}`, [], object),
  ...(cause instanceof Sim3AlignError ? { code: cause.code } : {}),
});

/** Remedies for programs, which name arguments and calls. */
const ofPrograms = /\b(pass|convert it:)\b|\w\(\)|`/i;

/** What a person does instead, by the code of the error; the page has words for it. */
export const onPage: Partial<Record<ErrorCode, string>> = {};

/** The words for an error, with what a person can do. */
export function messageOf(cause: unknown): string {
  if (!(cause instanceof Sim3AlignError)) return cause instanceof Error ? cause.message : `${cause}`;
  const { argument, code, found, expected, remedy } = cause;
  // The part of a file, such as the fx of a camera.
  const part = /\.(\w+)$/.exec(argument)?.[1];
  const helps = ofPrograms.test(remedy) ? (onPage[code] ?? "") : remedy;
  return `${part === undefined ? "" : `${part}: `}Found ${found}; expected ${expected}. ${helps}`;
}

const fields: readonly Field[] = ["depth", "mask", "mesh", "camera", "photo"];

/** The field that an error of `align` concerns, or null. */
export function fieldOf(cause: unknown): Field | null {
  if (!(cause instanceof Sim3AlignError)) return null;
  const { argument } = cause;
  if (argument.startsWith("image")) return "photo";
  return fields.find((field) => argument === field || argument.startsWith(`${field}.`)) ?? null;
}

/** The inputs without one of the objects. */
export const withoutObject =
  (index: number) =>
  (inputs: Inputs): Inputs => ({ ...inputs, objects: inputs.objects.filter((_, i) => i !== index) });
