/** Files as bytes, and detection of their type. */

import type { LoadedModule } from "../modules/module.js";
import { checkAttached } from "../values/border.js";
import { describe, failure, invalidArgument, messageOf } from "../values/error.js";
import { isBuffer, isKind, isTypedArray } from "../values/kinds.js";
import { wrongKind } from "../values/validation.js";

/** An array of bytes. */
export type Bytes = Uint8Array | Uint8ClampedArray;

/** Whether the value is an array of bytes. */
export const isBytes = (value: unknown): value is Bytes => isTypedArray(value, "Uint8Array", "Uint8ClampedArray");

/** Whether the value is the content of a file, rather than an object with arrays. */
export const isContent = (value: unknown): value is Uint8Array | ArrayBuffer =>
  ArrayBuffer.isView(value) || isBuffer(value);

/**
 * The bytes of a file, or `null`. Cannot distinguish a file from pixels in a `Uint8Array`.
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for memory that is detached, and `FILE_NOT_FOUND` if a `Blob` or a `File` cannot be read
 */
export async function fileBytes(argument: string, value: unknown): Promise<Uint8Array | null> {
  const isArray = isTypedArray<Uint8Array>(value, "Uint8Array");
  if (isArray || isBuffer(value)) {
    checkAttached(argument, value);
    return isArray ? value : new Uint8Array(value);
  }
  if (!isKind<Blob>(value, "Blob", "File")) return null;
  try {
    return new Uint8Array(await value.arrayBuffer());
  } catch (cause) {
    const found = `a ${describe(value)} that cannot be read: ${messageOf(cause)}`;
    const remedy = "The file may have been changed or removed: select it again.";
    throw failure("FILE_NOT_FOUND", argument, found, "a file that can be read", remedy, cause);
  }
}

/**
 * Calls a reader of files.
 * @param rename of the arguments in errors
 */
export async function callReader<G, T>(
  load: () => Promise<LoadedModule<G>>,
  argument: string,
  bytes: Uint8Array,
  read: (readers: G) => T,
  rename?: (argument: string) => string,
): Promise<T> {
  return (await load()).callWith(argument, bytes, read, rename);
}

/** The bytes of a file; `argument` is its name in errors. */
export async function requiredBytes(argument: string, file: unknown): Promise<Uint8Array> {
  const bytes = await fileBytes(argument, file);
  if (bytes !== null) return bytes;
  throw invalidArgument(argument, file, "the bytes of a file", "Pass a Uint8Array, an ArrayBuffer or a Blob.");
}

const imageBeginnings = ["\x89PNG\r\n\x1a\n", "\x93NUMPY", "\xff\xd8\xff", "GIF8", "RIFF"];

/** Whether the bytes start with the signature of an image file, which the pixels of a mask never do. */
export function beginsLikeImage(bytes: Uint8Array): boolean {
  const beginning = String.fromCharCode(...bytes.subarray(0, 8));
  return imageBeginnings.some((magic) => beginning.startsWith(magic));
}

/** Whether the bytes start like a JSON object, or an array of objects or arrays, after an optional byte order mark. */
export function beginsLikeJson(bytes: Uint8Array): boolean {
  const beginning = String.fromCharCode(...bytes.subarray(0, 64));
  return /^(\xef\xbb\xbf)?\s*(\{|\[\s*[[{\]])/.test(beginning);
}

/** The bytes of a file that is passed to a conversion, not copied. */
export function bytesOfFile(argument: string, file: unknown, expected: string): Uint8Array {
  if (isBuffer(file) || isTypedArray(file, "Uint8Array")) checkAttached(argument, file);
  if (isBuffer(file)) return new Uint8Array(file);
  if (isTypedArray<Uint8Array>(file, "Uint8Array")) return file;
  throw wrongKind(argument, file, expected, "Uint8Array");
}
