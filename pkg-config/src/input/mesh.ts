/** Meshes from arrays or mesh files. */

import { invalidArgument } from "../error.js";
import type { LoadFormats } from "../formats-module.js";
import type { CoreMesh } from "../prepared-mesh.js";
import { isRecord, isTypedArray, withoutUndefined, wrongKind } from "../values.js";
import { callReader, fileBytes } from "./bytes.js";
import type { MeshFile } from "./types.js";

const kinds =
  "{ positions, indices? }, or the bytes of a GLB, glTF, OBJ, PLY or STL file (also as { bytes, format?, resources? })";

/** The arrays of a mesh. */
export async function readMesh(mesh: unknown, formats: LoadFormats): Promise<CoreMesh> {
  if (isRecord(mesh) && "positions" in mesh) return arrays(mesh);
  const file: { [K in keyof MeshFile]?: unknown } = isRecord(mesh) ? mesh : { bytes: mesh };
  const bytes = await fileBytes("mesh", file.bytes);
  if (bytes === null) throw invalidArgument("mesh", mesh, kinds, "Pass the mesh to align.");
  const { format, resources } = file as Omit<MeshFile, "bytes">;
  const options = withoutUndefined({ format, resources });
  return callReader(formats, "mesh", bytes, (readers) => readers.readMesh(bytes, options), ofMesh);
}

/** The options of the reader are properties of the mesh. */
const ofMesh = (argument: string) => argument.replace(/^options\./, "mesh.");

function arrays({ positions, indices }: Record<string, unknown>): CoreMesh {
  if (!isTypedArray<Float32Array>(positions, "Float32Array")) {
    throw wrongKind("mesh.positions", positions, "a Float32Array, x, y, z per vertex", "Float32Array");
  }
  if (indices === undefined || indices === null) return { positions };
  if (isTypedArray<Uint32Array | Uint16Array>(indices, "Uint32Array", "Uint16Array")) return { positions, indices };
  const expected = "a Uint32Array or a Uint16Array, three indices per triangle";
  throw wrongKind("mesh.indices", indices, expected, "Uint32Array");
}
