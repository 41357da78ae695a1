/** Telling values from each other, whichever realm (window, worker, test runner) they come from. */
import { invalidArgument, type Sim3AlignError } from "./error.js";

/** Whether the value is of one of these built-in kinds. */
export function isKind<T>(value: unknown, ...names: string[]): value is T {
  return names.includes(Object.prototype.toString.call(value).slice(8, -1));
}

/** An object that is no array, no buffer and no file. */
export function isRecord(value: unknown): value is Record<string, unknown> {
  return isKind(value, "Object");
}

/** Whether this is a typed array, of one of these kinds. */
export function isTypedArray<T>(value: unknown, ...names: string[]): value is T {
  return ArrayBuffer.isView(value) && isKind(value, ...names);
}

/** An error that says which typed array belongs in place of a plain one, or of another. */
export function wrongKind(argument: string, value: unknown, expected: string, typedArray: string): Sim3AlignError {
  const isArray = Array.isArray(value) || (ArrayBuffer.isView(value) && !isKind(value, "DataView"));
  const remedy = isArray ? `Convert it: ${typedArray}.from(${argument}).` : "Pass one of these.";
  return invalidArgument(argument, value, expected, remedy);
}

/** Numbers as a plain array, from an array of any kind; anything else as it is, for the core to judge. */
export function plainNumbers(value: unknown): unknown {
  return ArrayBuffer.isView(value) && !isKind(value, "DataView") ? Array.from(value as unknown as number[]) : value;
}

/** The object without its undefined properties. */
export function withoutUndefined<T extends object>(object: T): { [K in keyof T]?: Exclude<T[K], undefined> } {
  const entries = Object.entries(object).filter(([, value]) => value !== undefined);
  return Object.fromEntries(entries) as { [K in keyof T]?: Exclude<T[K], undefined> };
}

/** What the file readers call options are properties of the input for our callers. */
export const withoutOptions = (argument: string) => argument.replace(/^options\./, "");
