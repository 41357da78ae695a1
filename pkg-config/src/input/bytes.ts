/** Files as bytes, and how they begin. */
import { isKind } from "../values.js";
import type { EncodedBytes } from "./types.js";

/** The bytes of a file; `null` for what is none. Pixels in a `Uint8Array` look the same: the caller has to know. */
export async function fileBytes(value: unknown): Promise<Uint8Array | null> {
  if (isKind<Uint8Array>(value, "Uint8Array")) return value;
  if (isKind<ArrayBuffer>(value, "ArrayBuffer")) return new Uint8Array(value);
  if (isKind<Blob>(value, "Blob", "File")) return new Uint8Array(await value.arrayBuffer());
  return null;
}

/** Whether {@link fileBytes} would give bytes. */
export const isFile = (value: unknown): value is EncodedBytes =>
  isKind(value, "Uint8Array", "ArrayBuffer", "Blob", "File");

const imageBeginnings = ["\x89PNG\r\n\x1a\n", "\x93NUMPY", "\xff\xd8\xff", "GIF8", "RIFF"];

/** Whether the bytes begin as an image file does. No mask's pixels do. */
export function beginsLikeImage(bytes: Uint8Array): boolean {
  const beginning = String.fromCharCode(...bytes.subarray(0, 8));
  return imageBeginnings.some((magic) => beginning.startsWith(magic));
}

/** Whether the bytes begin as a JSON object does. */
export function beginsLikeJson(bytes: Uint8Array): boolean {
  const beginning = String.fromCharCode(...bytes.subarray(0, 64));
  return beginning.trimStart().startsWith("{");
}
