/** Parsing of JSON files, and of numbers in them. */
import { failure } from "./error.js";
import { isKind, isRecord } from "./kinds.js";

/** A JSON file: its bytes, its text, or its parsed content. */
export type JsonFile = Uint8Array | string | object;

/** Maximum size of a JSON file in bytes: 16 MiB. */
const MAX_BYTES = 1 << 24;

/**
 * The content of a JSON file.
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` for text that is not JSON, `FILE_TOO_LARGE`
 */
export function parsedJson(argument: string, file: JsonFile): unknown {
  if (typeof file !== "string" && !isKind<Uint8Array>(file, "Uint8Array")) return file;
  if (file.length > MAX_BYTES) {
    const remedy = "Files of cameras, masks and poses are far smaller: check that this is the right file.";
    throw failure("FILE_TOO_LARGE", argument, `${file.length} bytes of JSON`, `at most ${MAX_BYTES}`, remedy);
  }
  try {
    const text =
      typeof file === "string" ? file.replace(/^\ufeff/, "") : new TextDecoder("utf-8", { fatal: true }).decode(file);
    return JSON.parse(text, (_, value) => {
      if (typeof value === "number" && !Number.isFinite(value)) throw new RangeError("a number out of range");
      return value;
    });
  } catch (cause) {
    const found = `text that is not JSON: ${cause instanceof Error ? cause.message : cause}`;
    throw failure(
      "CORRUPT_FILE",
      argument,
      found,
      "JSON",
      "The file is damaged or incomplete: download or export it again.",
    );
  }
}

/** `count` numbers, from a flat array or an array of rows; `null` for anything else. */
export function numbersIn(value: unknown, count: number): number[] | null {
  if (!Array.isArray(value)) return null;
  const numbers: unknown[] = value.flat();
  return numbers.length === count && numbers.every(isNumber) ? numbers : null;
}

/** Whether the value is a finite number. */
export const isNumber = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);

/** The property names of a JSON object, for error messages. */
export const keysText = (object: Record<string, unknown>) => Object.keys(object).slice(0, 12).join(", ") || "nothing";

/** Describes a JSON value for error messages; long text is truncated. */
export function shown(value: unknown): string {
  if (value === undefined) return "nothing";
  // A caller's object may contain what JSON cannot.
  const json = () => JSON.stringify(value, (_, part) => (typeof part === "bigint" ? `${part}` : part));
  const text = isRecord(value) ? `an object with ${keysText(value)}` : (json() ?? typeof value);
  return text.length > 60 ? `${text.slice(0, 60)}…` : text;
}
