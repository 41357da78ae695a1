/** Reads the mask and the mesh of an object, each file once, with the files that a mesh refers to. */
import { type MeshFormat, Sim3AlignError } from "sim3align";
import { resizedMask } from "sim3align/conventions/resize";
import { externalResources, type MeshFromFile } from "sim3align/formats";
import { refersToFiles } from "sim3align/input/formats";
import type { MaskSource, MeshSource, NamedFile } from "../state/inputs.js";
import { once } from "../state/inputs.js";
import { MAX_BYTES } from "./allowance.js";
import { extension } from "./files.js";
import { type ReadMask, readMask, readMesh, shownGlb } from "./reader.js";

const markedBy = once(async (file: NamedFile): Promise<ReadMask> => readMask(await file.bytes()));

/** The mask of a source. */
export async function maskOf(source: MaskSource): Promise<ReadMask> {
  const mask = await markedBy(source.file);
  if (source.isInverted !== true) return mask;
  return { ...mask, data: mask.data.map((inside) => (inside === 0 ? 1 : 0)), reading: "inverted" };
}

/** The mask at the size of the depth map. */
export function atSize(mask: ReadMask, width: number, height: number, resize: boolean): Uint8Array {
  if (mask.width === width && mask.height === height) return mask.data;
  if (resize) return resizedMask(mask, { width, height }).data;
  throw new Sim3AlignError({
    code: "SIZE_MISMATCH",
    argument: "mask",
    found: `${mask.width} × ${mask.height} pixels`,
    expected: `${width} × ${height}, the size of the depth map`,
    remedy: "Export the mask at the size of the depth map, or resize it.",
  });
}

/** A mesh, and its bytes if it is a GLB that the 3D view can load. */
export interface LoadedMesh {
  mesh: MeshFromFile;
  glb: Uint8Array | null;
}

/** Meshes that are being decoded, and those that an object still has: what no scene shows, memory does not keep. */
const loading = new WeakMap<MeshSource, Promise<LoadedMesh>>();
const known = new WeakMap<MeshSource, WeakRef<MeshFromFile>>();
const glbOf = new WeakMap<MeshFromFile, LoadedMesh["glb"]>();

/** The mesh of a source. */
export function meshOf(source: MeshSource): Promise<LoadedMesh> {
  const mesh = known.get(source)?.deref();
  if (mesh !== undefined) return Promise.resolve({ mesh, glb: glbOf.get(mesh) ?? null });
  const started = loading.get(source) ?? load(source).finally(() => loading.delete(source));
  loading.set(source, started);
  return started;
}

async function load(source: MeshSource): Promise<LoadedMesh> {
  const { file, siblings } = source;
  if ((file.size ?? 0) > MAX_BYTES) {
    throw new Sim3AlignError({
      ...{ code: "FILE_TOO_LARGE", argument: "mesh", expected: "at most 1 GB" },
      found: `${((file.size ?? 0) / 1e9).toFixed(1)} GB`,
      remedy: "Simplify the mesh: the search uses ten thousand triangles at most.",
    });
  }
  const bytes = await file.bytes();
  const ending = extension(file.path);
  const glb = shownGlb(bytes);
  const keep = (mesh: MeshFromFile): LoadedMesh => {
    known.set(source, new WeakRef(mesh));
    glbOf.set(mesh, glb);
    return { mesh, glb };
  };
  if (!refersToFiles(file.path)) return keep(await readMesh(bytes));
  const resources: Record<string, Uint8Array> = {};
  const addResources = async (file: Uint8Array) => {
    const { shape, colors } = await externalResources(file);
    for (const name of [...shape, ...colors].filter((name) => !(name in resources))) {
      const found = siblings.find(({ path }) => path.endsWith(decoded(name)));
      if (found === undefined) continue;
      const content = await found.bytes();
      resources[name] = content;
      // The material libraries of an OBJ refer to textures.
      if (name.endsWith(".mtl")) await addResources(content);
    }
  };
  await addResources(bytes);
  return keep(await readMesh(bytes, { format: ending as MeshFormat, resources }));
}

/** A name in a mesh file, which may be a URI. */
function decoded(name: string): string {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}
