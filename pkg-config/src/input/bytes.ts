/** Files as bytes, and detection of their type. */
import { invalidArgument } from "../error.js";
import { isKind } from "../values.js";

/** The bytes of a file, or `null`. Cannot distinguish a file from pixels in a `Uint8Array`. */
export async function fileBytes(value: unknown): Promise<Uint8Array | null> {
  if (isKind<Uint8Array>(value, "Uint8Array")) return value;
  if (isKind<ArrayBuffer>(value, "ArrayBuffer")) return new Uint8Array(value);
  if (isKind<Blob>(value, "Blob", "File")) return new Uint8Array(await value.arrayBuffer());
  return null;
}

/** The bytes of a file; `argument` is its name in errors. */
export async function requiredBytes(argument: string, file: unknown): Promise<Uint8Array> {
  const bytes = await fileBytes(file);
  if (bytes !== null) return bytes;
  throw invalidArgument(argument, file, "the bytes of a file", "Pass a Uint8Array, an ArrayBuffer or a Blob.");
}

const imageBeginnings = ["\x89PNG\r\n\x1a\n", "\x93NUMPY", "\xff\xd8\xff", "GIF8", "RIFF"];

/** Whether the bytes start with the signature of an image file, which the pixels of a mask never do. */
export function beginsLikeImage(bytes: Uint8Array): boolean {
  const beginning = String.fromCharCode(...bytes.subarray(0, 8));
  return imageBeginnings.some((magic) => beginning.startsWith(magic));
}

/** Whether the bytes start like a JSON object, after an optional byte order mark. */
export function beginsLikeJson(bytes: Uint8Array): boolean {
  const beginning = String.fromCharCode(...bytes.subarray(0, 64));
  return beginning
    .replace(/^\xef\xbb\xbf/, "")
    .trimStart()
    .startsWith("{");
}
