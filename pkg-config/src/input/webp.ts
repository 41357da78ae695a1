/** WebP images, which a module of their own decodes. */
import type { FileReaders } from "../modules/readers.js";
import { isTypedArray } from "../values/kinds.js";
import type { PixelArray } from "../values/pixels.js";

/** The readers of images. */
export type ImageReaders = Pick<FileReaders, "formats" | "webp">;

/** Decodes an image within a mesh file; `undefined` if it cannot. */
export type DecodeImage = (bytes: Uint8Array) => PixelArray<Uint8Array> | undefined;

const latin = (bytes: Uint8Array) => new TextDecoder("latin1").decode(bytes);

/** Whether a file is a WebP. */
export const isWebp = (bytes: Uint8Array): boolean => /^RIFF[\s\S]{4}WEBP/.test(latin(bytes.subarray(0, 12)));

/**
 * A decoder for the textures of a mesh file: of WebP, if there is any in the file or its resources, else that of the caller.
 * @param own the caller's
 */
export async function imageDecoder(
  bytes: Uint8Array,
  resources: unknown,
  own: DecodeImage | undefined,
  { webp }: Pick<FileReaders, "webp">,
): Promise<DecodeImage | undefined> {
  const files = [...Object.values(resources ?? {}), bytes].filter((file) =>
    isTypedArray<Uint8Array>(file, "Uint8Array"),
  );
  if (!files.some((file) => isWebp(file) || mentionsWebp(file))) return own;
  const module = await webp();
  return (image) => (isWebp(image) ? module.call((decoder) => decoder.decodeWebp(image, true)) : own?.(image));
}

/** Whether a glTF names WebP as the format of an image. */
const mentionsWebp = (bytes: Uint8Array) => /image\/webp|EXT_texture_webp|\.webp"/i.test(gltfText(bytes));

/** The JSON of a glTF, also of a binary one, as text for a search; empty for other files. */
export function gltfText(bytes: Uint8Array): string {
  const beginning = latin(bytes.subarray(0, 64)).trimStart();
  if (!/^(glTF|\{)/.test(beginning)) return "";
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  // The JSON of a binary file is its first chunk.
  const json =
    beginning.startsWith("glTF") && bytes.length >= 20 ? bytes.subarray(20, 20 + view.getUint32(12, true)) : bytes;
  return latin(json);
}
