/** Textured meshes and photos as files, for measurements. */
import { rgbPng } from "../lib/png.mjs";
import { compiledModule } from "./inputs.mjs";

/** Width of the blocks of one colour in {@link blocksPng}, pixels. */
const block = 16;

/**
 * A PNG of coloured blocks.
 * @param {number[]} size width and height
 * @returns {Uint8Array}
 */
export function blocksPng([width = 1, height = 1]) {
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let v = 0; v < height; v++) {
    for (let u = 0; u < width; u++) {
      const at = Math.floor(u / block) * 7919 + Math.floor(v / block) * 104_729;
      // The first byte of a row says that it is not filtered.
      rows.writeUIntBE((Math.imul(at + 1, 2_654_435_761) >>> 8) & 0xffffff, v * (1 + 3 * width) + 1 + 3 * u, 3);
    }
  }
  return rgbPng(rows, width, height, 1);
}

/**
 * A GLB of a mesh with a texture, whose coordinates are x and y.
 * @param {import("./inputs.mjs").Mesh} mesh
 * @param {Uint8Array} png
 * @returns {Promise<Uint8Array>}
 */
export async function texturedGlb({ positions, indices }, png) {
  const { glbOfParts } = await compiledModule("conventions/glb.js");
  const count = positions.length / 3;
  const coordinates = new Float32Array(2 * count).map((_, i) => (positions[3 * (i >> 1) + (i % 2)] ?? 0) + 0.5);
  const views = [positions, coordinates, indices, png].map(
    ({ buffer, byteOffset, byteLength }) => new Uint8Array(buffer, byteOffset, byteLength),
  );
  let end = 0;
  const bufferViews = views.map(({ length }) => {
    const view = { buffer: 0, byteOffset: end, byteLength: length };
    end += Math.ceil(length / 4) * 4;
    return view;
  });
  const json = {
    asset: { version: "2.0" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
    textures: [{ source: 0 }],
    images: [{ bufferView: 3, mimeType: "image/png" }],
    accessors: [
      { bufferView: 0, componentType: 5126, count, type: "VEC3" },
      { bufferView: 1, componentType: 5126, count, type: "VEC2" },
      { bufferView: 2, componentType: 5125, count: indices.length, type: "SCALAR" },
    ],
    bufferViews,
    buffers: [{ byteLength: end }],
  };
  const binary = new Uint8Array(end);
  for (const [i, { byteOffset }] of bufferViews.entries()) binary.set(views[i] ?? [], byteOffset);
  return glbOfParts({ json, binary });
}
