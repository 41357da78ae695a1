/** The number of triangles of a mesh by the beginning of its file, so that no mesh is decoded that is too large. */
import { Sim3AlignError } from "sim3align";
import type { NamedFile } from "../state/inputs.js";
import { MAX_BYTES } from "./allowance.js";
import { baseName } from "./files.js";

/** The most triangles that the aligner takes: `MAX_TRIANGLES` in `geometry/src/surface.rs`. */
export const MAX_TRIANGLES = 1 << 22;

/** The beginning of a file that says which format it is, and the longest header of a PLY file that is looked at. */
const HEAD_BYTES = 1 << 12;

/** The longest JSON of a GLB file that is read for its counts. */
const MAX_JSON_BYTES = 1 << 26;

/** @throws {@link Sim3AlignError} `FILE_TOO_LARGE` for a mesh with too many triangles, before the file is read as a whole */
export async function checkMeshSize(file: NamedFile): Promise<void> {
  const triangles = await declaredTriangles(file);
  const shown = (count: number) => count.toLocaleString("en-GB").replaceAll(",", " ");
  if (triangles !== null && triangles > MAX_TRIANGLES) {
    throw tooLarge(`${shown(triangles)} triangles`, `at most ${shown(MAX_TRIANGLES)}`);
  }
  const { size = 0 } = file;
  if (size > MAX_BYTES) throw tooLarge(`${(size / 1e9).toFixed(1)} GB`, "at most 1 GB");
}

const tooLarge = (found: string, expected: string) =>
  new Sim3AlignError({
    ...{ code: "FILE_TOO_LARGE", argument: "mesh", found, expected },
    remedy: "Simplify the mesh: the search uses ten thousand triangles at most.",
  });

/** What the header of a GLB, a PLY or a binary STL file says; null for other files, and damaged ones. */
export async function declaredTriangles(file: NamedFile): Promise<number | null> {
  const head = await beginningOf(file, HEAD_BYTES);
  const view = new DataView(head.buffer, head.byteOffset, head.length);
  const text = new TextDecoder("latin1").decode(head);
  if (text.startsWith("glTF") && head.length >= 20) {
    const length = view.getUint32(12, true);
    if (length > MAX_JSON_BYTES) return null;
    const json = (await beginningOf(file, 20 + length)).subarray(20);
    return trianglesOfGltf(json);
  }
  if (text.startsWith("ply")) {
    const count = /^element face (\d+)/m.exec(text.split("end_header")[0] ?? "")?.[1];
    return count === undefined ? null : Number(count);
  }
  if (head.length < 84) return null;
  const count = view.getUint32(80, true);
  // A text that begins with "solid" says no such size.
  return file.size === 84 + 50 * count && baseName(file.path).toLowerCase().endsWith(".stl") ? count : null;
}

async function beginningOf(file: NamedFile, length: number): Promise<Uint8Array> {
  return file.head === undefined ? (await file.bytes()).subarray(0, length) : file.head(length);
}

/** The parts of a glTF file that count. */
interface Gltf {
  accessors?: { count?: number }[];
  meshes?: { primitives?: { attributes?: { POSITION?: number }; indices?: number; mode?: number }[] }[];
  nodes?: { mesh?: number }[];
}

/** Modes of primitives: triangles, and strips and fans of them. */
const [TRIANGLES, STRIP, FAN] = [4, 5, 6];

/** Each mesh counts once for each node that shows it. */
function trianglesOfGltf(json: Uint8Array): number | null {
  try {
    const { accessors = [], meshes = [], nodes = [] } = JSON.parse(new TextDecoder().decode(json)) as Gltf;
    const counts = meshes.map(({ primitives = [] }) =>
      primitives.reduce((sum, { attributes = {}, indices, mode = TRIANGLES }) => {
        const count = accessors[indices ?? attributes.POSITION ?? -1]?.count ?? 0;
        return sum + (mode === TRIANGLES ? count / 3 : mode === STRIP || mode === FAN ? Math.max(0, count - 2) : 0);
      }, 0),
    );
    const shown = nodes.reduce((sum, { mesh = -1 }) => sum + (counts[mesh] ?? 0), 0);
    return Math.floor(shown);
  } catch {
    return null;
  }
}
