/** Textured meshes and photos as files, for measurements. */
import { deflateSync } from "node:zlib";

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
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  // 8 bits, RGB.
  header.set([8, 2], 8);
  const chunk = (/** @type {string} */ kind, /** @type {Buffer} */ data) => {
    const body = Buffer.concat([Buffer.from(kind), data]);
    const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(data.length);
    sum.writeUInt32BE(crc32(body));
    return Buffer.concat([length, body, sum]);
  };
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  const pixels = chunk("IDAT", deflateSync(rows, { level: 1 }));
  return new Uint8Array(Buffer.concat([signature, chunk("IHDR", header), pixels, chunk("IEND", Buffer.alloc(0))]));
}

/** The checksum of PNG's chunks, which zlib of Node 20.0 lacks. @param {Buffer} bytes */
function crc32(bytes) {
  const table = Int32Array.from({ length: 256 }, (_, byte) => {
    for (let bit = 0; bit < 8; bit++) byte = byte & 1 ? (byte >>> 1) ^ 0xedb88320 : byte >>> 1;
    return byte;
  });
  let crc = -1;
  for (const byte of bytes) crc = (crc >>> 8) ^ (table[(crc ^ byte) & 255] ?? 0);
  return ~crc >>> 0;
}

/**
 * A GLB of a mesh with a texture, whose coordinates are x and y.
 * @param {import("./inputs.mjs").Mesh} mesh
 * @param {Uint8Array} png
 * @returns {Uint8Array}
 */
export function texturedGlb({ positions, indices }, png) {
  const count = positions.length / 3;
  const coordinates = new Float32Array(2 * count).map((_, i) => (positions[3 * (i >> 1) + (i % 2)] ?? 0) + 0.5);
  const views = [positions, coordinates, indices, png].map(({ buffer, byteOffset, byteLength }) =>
    Buffer.from(buffer, byteOffset, byteLength),
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
  const padded = (/** @type {Buffer} */ bytes, /** @type {string} */ fill) =>
    Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4, fill)]);
  const text = padded(Buffer.from(JSON.stringify(json)), " ");
  const binary = Buffer.concat(views.map((view) => padded(view, "\0")));
  const word = (/** @type {number} */ value) => {
    const bytes = Buffer.alloc(4);
    bytes.writeUInt32LE(value);
    return bytes;
  };
  const total = 28 + text.length + binary.length;
  const parts = [Buffer.from("glTF"), word(2), word(total), word(text.length), Buffer.from("JSON"), text];
  return new Uint8Array(Buffer.concat([...parts, word(binary.length), Buffer.from("BIN\0"), binary]));
}
