/** glTF files as others see them: Khronos' validator and three.js' loader. */
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { type BufferGeometry, Mesh, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

interface Report {
  issues: { numErrors: number; numWarnings: number; messages: { code: string; message: string; pointer?: string }[] };
  info: { totalVertexCount: number; totalTriangleCount: number };
}

// The package has no types.
const { validateBytes } = createRequire(import.meta.url)("gltf-validator") as {
  validateBytes(bytes: Uint8Array): Promise<Report>;
};

/** Checks that a file is without errors and warnings; returns what the validator says about it. */
export async function assertValid(glb: Uint8Array): Promise<Report["info"]> {
  const { issues, info } = await validateBytes(glb);
  const serious = issues.messages.map(({ code, message, pointer }) => `${code} ${message} ${pointer ?? ""}`);
  assert.equal(issues.numErrors + issues.numWarnings, 0, serious.join("\n"));
  return info;
}

/** A GLB as three.js reads it. */
export const gltfOf = (glb: Uint8Array) => new GLTFLoader().parseAsync(Uint8Array.from(glb).buffer, "");

/** The scene of a GLB. */
export const loadGlb = async (glb: Uint8Array) => (await gltfOf(glb)).scene;

/** All vertices of a GLB in its world; without those of the support. */
export async function verticesOf(glb: Uint8Array): Promise<number[]> {
  const scene = await loadGlb(glb);
  scene.updateMatrixWorld(true);
  const found: number[] = [];
  scene.traverse((child) => {
    if (!(child instanceof Mesh) || child.name === "support") return;
    const { position } = (child.geometry as BufferGeometry).attributes;
    for (let i = 0; i < (position?.count ?? 0); i++) {
      const vertex = new Vector3().fromBufferAttribute(position as never, i).applyMatrix4(child.matrixWorld);
      found.push(...vertex.toArray());
    }
  });
  return found;
}
