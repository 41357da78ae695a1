/**
 * The file readers alone: depth maps, masks, meshes and cameras, without the aligner. `Aligner.align` takes the same files as they
 * are; these are for those who want to look at what is in them.
 * @packageDocumentation
 */
import { invalidArgument } from "./error.js";
import { formatsModule } from "./formats-module.js";
import { fileBytes } from "./input/bytes.js";
import type { CocoRle, EncodedBytes, MeshFormat } from "./input/types.js";
import { isRecord, withoutUndefined } from "./values.js";
import type { CameraFile, DepthImage, MaskImage, MeshArrays } from "./wasm/formats.js";
import type { WasmSource } from "./wasm-module.js";

export { type ErrorCode, type ErrorParts, Sim3AlignError } from "./error.js";
export type { CocoRle, EncodedBytes, MeshFormat } from "./input/types.js";
export type { CameraFile, DepthImage, MaskImage, MeshArrays } from "./wasm/formats.js";
export type { WasmSource } from "./wasm-module.js";

/**
 * Loads the readers' WebAssembly module. Only needed where it comes from elsewhere than `wasm/formats_bg.wasm` beside
 * this script; the first call counts.
 * @throws {@link Sim3AlignError} `NOT_INITIALISED`; the next call tries again
 */
export async function loadFormats(wasm?: WasmSource): Promise<void> {
  await formatsModule.load(wasm);
}

/**
 * Reads a 16-bit grey PNG or a `.npy` array: metres along the optical axis, row by row; 0 is no reading.
 * @param options.depthScale metres per unit, above 0; by default whole numbers are millimetres, and floats metres
 * @param options.integerDepthScale the same, for whole numbers alone: what a camera file says
 * @throws {@link Sim3AlignError} for what is no such file
 */
export async function readDepth(
  file: EncodedBytes,
  options: { depthScale?: number | undefined; integerDepthScale?: number | undefined } = {},
): Promise<DepthImage> {
  const bytes = await bytesOf(file);
  return (await formatsModule.load()).call((readers) => readers.readDepth(bytes, withoutUndefined(options)));
}

/**
 * Reads a PNG, a `.npy` array, or COCO RLE (as an object, or a file of JSON): row by row, 1 is the object.
 * @throws {@link Sim3AlignError} for what is no such file
 */
export async function readMask(file: EncodedBytes | CocoRle): Promise<MaskImage> {
  if (isRecord(file)) {
    const { size, counts } = file as { size: [number, number]; counts: string | number[] };
    return (await formatsModule.load()).call((readers) => readers.decodeCocoRle({ size, counts }));
  }
  const bytes = await bytesOf(file);
  return (await formatsModule.load()).call((readers) => readers.readMask(bytes));
}

/**
 * Reads GLB, glTF, OBJ, PLY or STL, all parts merged and node transforms applied, in the file's unit and axes.
 * @param options.format told from the content by default
 * @param options.resources the buffers of a `.gltf`, by the URIs that it names them with
 * @throws {@link Sim3AlignError} for what is no such file
 */
export async function readMesh(
  file: EncodedBytes,
  options: {
    format?: MeshFormat | undefined;
    resources?: Readonly<Record<string, Uint8Array | ArrayBuffer>> | undefined;
  } = {},
): Promise<MeshArrays> {
  const bytes = await bytesOf(file);
  return (await formatsModule.load()).call((readers) => readers.readMesh(bytes, withoutUndefined(options)));
}

/**
 * Reads a camera file: our own `camera.json`, BOP's `scene_camera.json`, ROS CameraInfo, Open3D's intrinsics; bytes, text
 * or parsed JSON. Pixel centres are at whole numbers.
 * @param options.width the image's size, to which stated intrinsics have to belong
 * @param options.imageId which entry of a `scene_camera.json`
 * @throws {@link Sim3AlignError} for what is no such file
 */
export async function readCamera(
  file: EncodedBytes | string | Readonly<Record<string, unknown>>,
  options: { width?: number | undefined; height?: number | undefined; imageId?: string | number | undefined } = {},
): Promise<CameraFile> {
  const content = isRecord(file) || typeof file === "string" ? file : await bytesOf(file);
  return (await formatsModule.load()).call((readers) => readers.readCamera(content, withoutUndefined(options)));
}

async function bytesOf(file: unknown): Promise<Uint8Array> {
  const bytes = await fileBytes(file);
  if (bytes !== null) return bytes;
  throw invalidArgument("file", file, "a file's bytes", "Pass a Uint8Array, an ArrayBuffer or a Blob.");
}
