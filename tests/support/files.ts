/** Encoders of the files that the tests pass, written independently of the package's readers. */

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { deflateSync } from "node:zlib";
import { repository } from "./environment.js";
import type { Mesh, View } from "./scene.js";

/** A file that another program wrote. */
export const fixture = (name: string) => new Uint8Array(readFileSync(join(repository, "tests", "fixtures", name)));

/** A `.npy` file, version 1.0. */
export function npy(data: Float32Array | Uint16Array | Uint8Array, height: number, width: number): Uint8Array {
  const descr = data instanceof Float32Array ? "<f4" : data instanceof Uint16Array ? "<u2" : "|u1";
  const dict = `{'descr': '${descr}', 'fortran_order': False, 'shape': (${height}, ${width}), }`;
  const header = `${dict.padEnd(64 * Math.ceil((dict.length + 11) / 64) - 11)}\n`;
  const length = Buffer.alloc(2);
  length.writeUInt16LE(header.length);
  const values = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
  return Buffer.concat([Buffer.from("\x93NUMPY\x01\x00", "latin1"), length, Buffer.from(header, "latin1"), values]);
}

/** The checksum of PNG's chunks and of files in zip archives (zlib's is not in Node 20). */
export function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return (crc ^ 0xffffffff) >>> 0;
}

/** A chunk of a PNG. */
export function pngChunk(type: string, content: Uint8Array): Uint8Array {
  const typed = Buffer.concat([Buffer.from(type, "latin1"), content]);
  const frame = Buffer.alloc(8);
  frame.writeUInt32BE(content.length, 0);
  frame.writeUInt32BE(crc32(typed), 4);
  return Buffer.concat([frame.subarray(0, 4), typed, frame.subarray(4)]);
}

/** A PNG, grey or (with three channels) of colours, of 8 bits from a `Uint8Array`, of 16 from a `Uint16Array`. */
export function png(data: Uint8Array | Uint16Array, width: number, height: number, channels: 1 | 3 = 1): Uint8Array {
  const bytes = data.BYTES_PER_ELEMENT;
  const values = width * channels;
  const rows = Buffer.alloc(height * (1 + values * bytes));
  data.forEach((value, i) => {
    const offset = Math.floor(i / values) * (1 + values * bytes) + 1 + (i % values) * bytes;
    if (bytes === 1) rows.writeUInt8(value, offset);
    else rows.writeUInt16BE(value, offset);
  });
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.writeUInt8(8 * bytes, 8);
  header.writeUInt8(channels === 3 ? 2 : 0, 9);
  const signature = Buffer.from("\x89PNG\r\n\x1a\n", "latin1");
  const none = new Uint8Array();
  return Buffer.concat([
    signature,
    pngChunk("IHDR", header),
    pngChunk("IDAT", deflateSync(rows)),
    pngChunk("IEND", none),
  ]);
}

/** A mask as a PNG of 0 and 255. */
export const maskPng = (mask: Uint8Array, width: number, height: number) =>
  png(
    mask.map((inside) => 255 * inside),
    width,
    height,
  );

/** The content of files by their paths; objects stand for JSON. */
export type Files = Record<string, Uint8Array | string | object>;

/** A view as the files of a case folder. */
export const viewFiles = ({ depth, mask, width, height, camera }: View) => ({
  "depth.npy": npy(depth, height, width),
  "mask.png": maskPng(mask, width, height),
  "camera.json": camera,
});

/** Writes files below a folder, and returns it. */
export function writeFiles(folder: string, files: Files): string {
  mkdirSync(folder, { recursive: true });
  for (const [path, content] of Object.entries(files)) {
    mkdirSync(dirname(join(folder, path)), { recursive: true });
    const isWritten = typeof content === "string" || content instanceof Uint8Array;
    writeFileSync(join(folder, path), isWritten ? content : JSON.stringify(content));
  }
  return folder;
}

/** A Wavefront OBJ file, whose vertices may have colours, 0 to 255. */
export function obj({ positions, indices, colors }: Mesh & { colors?: Uint8Array }): Uint8Array {
  const lines: string[] = [];
  for (let i = 0; i < positions.length; i += 3) {
    const color = Array.from(colors?.subarray(i, i + 3) ?? [], (c) => c / 255);
    lines.push(`v ${[...positions.slice(i, i + 3), ...color].join(" ")}`);
  }
  for (let i = 0; i < indices.length; i += 3) {
    lines.push(`f ${Array.from(indices.slice(i, i + 3), (index) => index + 1).join(" ")}`);
  }
  return Buffer.from(`${lines.join("\n")}\n`);
}

const padded = (bytes: Uint8Array, filler: string) => {
  const rest = (4 - (bytes.length % 4)) % 4;
  return Buffer.concat([bytes, Buffer.from(filler.repeat(rest), "latin1")]);
};

const bytesOf = (array: Float32Array | Uint32Array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

/** The JSON of a `.gltf` with a mesh whose arrays are one after the other in one buffer. */
export function gltfJson({ positions, indices }: Mesh, node: object = {}, buffer: object = {}) {
  return {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, ...node }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      {
        bufferView: 0,
        componentType: 5126,
        count: positions.length / 3,
        type: "VEC3",
        min: [-9, -9, -9],
        max: [9, 9, 9],
      },
      { bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: positions.byteLength },
      { buffer: 0, byteOffset: positions.byteLength, byteLength: indices.byteLength },
    ],
    buffers: [{ byteLength: positions.byteLength + indices.byteLength, ...buffer }],
  };
}

/** The JSON of a `.gltf` with a texture, whose coordinates are numbers of positions; `more` has its image. */
export function texturedJson(mesh: Mesh, texture: object, more: object) {
  const parts = gltfJson(mesh);
  const [primitive] = parts.meshes[0]?.primitives ?? [];
  return {
    ...parts,
    meshes: [{ primitives: [{ ...primitive, attributes: { POSITION: 0, TEXCOORD_0: 2 }, material: 0 }] }],
    accessors: [
      ...parts.accessors,
      { bufferView: 0, componentType: 5126, count: mesh.positions.length / 3, type: "VEC2" },
    ],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
    textures: [texture],
    ...more,
  };
}

/** The buffer of {@link gltfJson}. */
export const gltfBuffer = ({ positions, indices }: Mesh) => Buffer.concat([bytesOf(positions), bytesOf(indices)]);

/** A GLB file of any JSON and buffer. */
export function glbOf(json: object, buffer: Uint8Array): Uint8Array {
  const chunk = (type: number, content: Uint8Array) => {
    const header = Buffer.alloc(8);
    header.writeUInt32LE(content.length, 0);
    header.writeUInt32LE(type, 4);
    return Buffer.concat([header, content]);
  };
  const text = chunk(0x4e4f534a, padded(Buffer.from(JSON.stringify(json)), " "));
  const binary = chunk(0x004e4942, padded(buffer, "\0"));
  const header = Buffer.alloc(12);
  header.write("glTF", "latin1");
  header.writeUInt32LE(2, 4);
  header.writeUInt32LE(12 + text.length + binary.length, 8);
  return Buffer.concat([header, text, binary]);
}

/** The JSON of a GLB file. */
export const glbJson = (glb: Uint8Array) =>
  JSON.parse(
    new TextDecoder().decode(glb.subarray(20, 20 + new DataView(glb.buffer, glb.byteOffset).getUint32(12, true))),
  );

/** A GLB file of a mesh under one node. */
export const glb = (mesh: Mesh, node: object = {}) => glbOf(gltfJson(mesh, node), gltfBuffer(mesh));

/** COCO's uncompressed run lengths: down the columns, beginning with background. */
export function cocoRle(mask: Uint8Array, width: number, height: number): { size: [number, number]; counts: number[] } {
  const counts: number[] = [];
  let value = 0;
  let run = 0;
  for (let i = 0; i < mask.length; i++) {
    const pixel = (mask[(i % height) * width + Math.floor(i / height)] ?? 0) === 0 ? 0 : 1;
    if (pixel !== value) {
      counts.push(run);
      run = 0;
      value = pixel;
    }
    run += 1;
  }
  counts.push(run);
  return { size: [height, width], counts };
}
