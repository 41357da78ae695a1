/** Reads mesh files by the module that knows their format. */

import { holdsGaussians } from "../formats/splat-files.js";
import type { FileReaders } from "../modules/readers.js";
import type { MeshArrays, ReadMeshOptions } from "../wasm/formats.js";
import { callReader } from "./bytes.js";

/** The readers of mesh files. */
export type MeshReaders = Pick<FileReaders, "formats" | "splats">;

/**
 * Reads a mesh file of any supported format. The module for 3D Gaussians is loaded only for these.
 * @param argument the name of the bytes, in errors
 * @param options of the formats module, which checks them
 * @param rename of the arguments in errors of the reader
 */
export function decodeMesh(
  argument: string,
  bytes: Uint8Array,
  options: object,
  readers: MeshReaders,
  rename?: (argument: string) => string,
): Promise<MeshArrays> {
  const { format, colors } = options as { format?: unknown; colors?: unknown };
  if (holdsGaussians(bytes, format)) {
    const withColors = colors === undefined || Boolean(colors);
    return callReader(readers.splats, argument, bytes, (module) => module.readSplats(bytes, withColors), rename);
  }
  const read = options as ReadMeshOptions;
  return callReader(readers.formats, argument, bytes, (module) => module.readMesh(bytes, read), rename);
}
