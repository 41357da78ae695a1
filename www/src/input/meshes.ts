/** Reads mesh files, each once, with the files that they refer to. */
import { type MeshFormat, Sim3AlignError } from "sim3align";
import { externalResources, type MeshFromFile } from "sim3align/formats";
import { refersToFiles } from "sim3align/input/formats";
import type { MeshSource } from "../state/inputs.js";
import { once } from "../state/once.js";
import { MAX_BYTES } from "./allowance.js";
import { extension } from "./files.js";
import { readMesh } from "./reader.js";

/** A mesh, and its bytes if it is a GLB. */
export interface LoadedMesh {
  mesh: MeshFromFile;
  glb: Uint8Array | null;
}

/** The mesh of a source. */
export const meshOf = once(load);

async function load({ file, siblings }: MeshSource): Promise<LoadedMesh> {
  if ((file.size ?? 0) > MAX_BYTES) {
    throw new Sim3AlignError({
      ...{ code: "FILE_TOO_LARGE", argument: "mesh", expected: "at most 1 GB" },
      found: `${((file.size ?? 0) / 1e9).toFixed(1)} GB`,
      remedy: "Simplify the mesh: the search uses ten thousand triangles at most.",
    });
  }
  const bytes = await file.bytes();
  const ending = extension(file.path);
  if (!refersToFiles(file.path)) return { mesh: await readMesh(bytes), glb: ending === "glb" ? bytes : null };
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
  return { mesh: await readMesh(bytes, { format: ending as MeshFormat, resources }), glb: null };
}

/** A name in a mesh file, which may be a URI. */
function decoded(name: string): string {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}
