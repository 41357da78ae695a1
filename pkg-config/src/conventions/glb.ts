/** Export of placed meshes, and placement of existing GLB files. */

import type { Sim3Like } from "../input/sim3.js";
import type { MeshArrays } from "../input/types.js";
import { describe, failure } from "../values/error.js";
import { isRecord, oneOf, optionsOf } from "../values/values.js";
import { bytesOfFile } from "./file-bytes.js";
import { inFrame } from "./frames.js";
import { type GltfNode, type GltfNodeOptions, toGltfNode } from "./gltf-node.js";
import type { GltfParts } from "./merged-gltf.js";
import { meshOf } from "./mesh.js";
import { applyToPoints, sim3Of, similarityOf } from "./similarity.js";

/** Options of {@link exportGlb}. */
export interface GlbOptions extends GltfNodeOptions {
  /** "node", the default, keeps the vertices and transforms the node; "baked" transforms the vertices. */
  mode?: "node" | "baked" | undefined;
}

const magic = 0x46546c67;
const jsonChunk = 0x4e4f534a;
const binaryChunk = 0x004e4942;

/**
 * Exports a mesh at its pose relative to a camera at the origin, in metres, as a GLB file. The file contains positions
 * and triangles only; {@link placeGlb} keeps the materials of a GLB.
 *
 * @param mesh `positions` and `indices` of the aligned mesh
 * @param transform OpenCV camera from mesh: a result of `align`, whose metrics are kept in the node's extras
 *
 * @example
 * const bytes = exportGlb(mesh, result);
 * await writeFile("placed.glb", bytes);
 * @throws {@link Sim3AlignError} for an invalid mesh or transform, and `INVALID_OPTION`
 */
export function exportGlb(mesh: MeshArrays, transform: Sim3Like, options: GlbOptions = {}): Uint8Array {
  const { positions, indices } = meshOf("mesh", mesh);
  const { mode = "node", frame = "opengl" } = optionsOf(options);
  const isBaked = oneOf("options.mode", mode, ["node", "baked"]) === "baked";
  const node = toGltfNode(transform, options);
  const placed = sim3Of(inFrame("options.frame", similarityOf(transform), frame));
  const vertices = isBaked ? applyToPoints(placed, positions) : positions;
  const corners = indices === null ? new Uint32Array() : Uint32Array.from(indices);
  const buffer = new Uint8Array(vertices.byteLength + corners.byteLength);
  buffer.set(bytesOf(vertices));
  buffer.set(bytesOf(corners), vertices.byteLength);
  const [positionsView, cornersView] = [
    { buffer: 0, byteOffset: 0, byteLength: vertices.byteLength, target: 34962 },
    { buffer: 0, byteOffset: vertices.byteLength, byteLength: corners.byteLength, target: 34963 },
  ];
  const positionsAccessor = {
    ...{ bufferView: 0, componentType: 5126, type: "VEC3", count: vertices.length / 3 },
    ...bounds(vertices),
  };
  const cornersAccessor = { bufferView: 1, componentType: 5125, type: "SCALAR", count: corners.length };
  const hasIndices = corners.length > 0;
  const primitive = { attributes: { POSITION: 0 }, ...(hasIndices ? { indices: 1 } : {}) };
  const json = {
    asset: { version: "2.0", generator: "sim3align" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ ...(isBaked ? { name: node.name, extras: node.extras } : node), mesh: 0 }],
    meshes: [{ primitives: [primitive] }],
    accessors: hasIndices ? [positionsAccessor, cornersAccessor] : [positionsAccessor],
    bufferViews: hasIndices ? [positionsView, cornersView] : [positionsView],
    buffers: [{ byteLength: buffer.byteLength }],
  };
  return glbOf(json, [[binaryChunk, buffer]]);
}

/**
 * Places an existing GLB by adding a parent node above its scene. Materials, textures and animations are kept; nothing
 * is decoded.
 *
 * @param glb the bytes of the aligned file
 * @param transform OpenCV camera from mesh: a result of `align` for the same file
 *
 * @example
 * const bytes = placeGlb(generated, await aligner.align({ depth, mask, camera, mesh: generated }));
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` if the bytes are not a GLB, `UNSUPPORTED_FORMAT` for glTF 1
 */
export function placeGlb(
  glb: Uint8Array | ArrayBuffer,
  transform: Sim3Like,
  options: GltfNodeOptions = {},
): Uint8Array {
  return underNode(glb, toGltfNode(transform, options));
}

/** A GLB with one more node above its scene. */
export function underNode(glb: Uint8Array | ArrayBuffer, parent: Partial<GltfNode>): Uint8Array {
  const { json, others } = chunksOf(glb);
  const nodes = objectsOf(json, "nodes");
  const children = new Set(nodes.flatMap((node) => node.children ?? []));
  const roots = nodes.flatMap((_, i) => (children.has(i) ? [] : [i]));
  const scenes = json.scenes === undefined ? [{ nodes: roots }] : objectsOf(json, "scenes");
  const scene = typeof json.scene === "number" ? json.scene : 0;
  const shown = (scenes[scene]?.nodes ?? []) as number[];
  const node: Partial<GltfNode> & { children?: number[] } = { ...parent };
  // glTF does not allow an empty list of children.
  if (shown.length > 0) node.children = shown;
  const placed = {
    ...json,
    scene,
    scenes: scenes.map((other, i) => (i === scene ? { ...other, nodes: [nodes.length] } : other)),
    nodes: [...nodes, node],
  };
  return glbOf(placed, others);
}

/** The parts of a GLB file. */
export function partsOf(glb: unknown): GltfParts {
  const { json, others } = chunksOf(glb);
  return { json, binary: others.find(([type]) => type === binaryChunk)?.[1] ?? new Uint8Array() };
}

/** The GLB file of its parts. */
export const glbOfParts = ({ json, binary }: GltfParts): Uint8Array =>
  glbOf(json, binary.length > 0 ? [[binaryChunk, binary]] : []);

/** The bytes of an array. */
export const bytesOf = (array: Float32Array | Uint32Array) =>
  new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

/** The least and the largest coordinates, as accessors of positions need them. */
export function bounds(vertices: ArrayLike<number>): { min: number[]; max: number[] } {
  const [min, max] = [Array<number>(3).fill(Number.POSITIVE_INFINITY), Array<number>(3).fill(Number.NEGATIVE_INFINITY)];
  for (let i = 0; i < vertices.length; i++) {
    const x = vertices[i] as number;
    min[i % 3] = Math.min(min[i % 3] ?? x, x);
    max[i % 3] = Math.max(max[i % 3] ?? x, x);
  }
  return { min, max };
}

/** The objects of an optional list in the JSON of the file. */
function objectsOf(json: Record<string, unknown>, name: string): Record<string, unknown>[] {
  const list = json[name] ?? [];
  if (Array.isArray(list) && list.every(isRecord)) return list;
  throw failure("CORRUPT_FILE", "glb", `${describe(list)} as its ${name}`, "a list of objects", "Export it again.");
}

/** A GLB file of a JSON chunk and other chunks, each padded to a multiple of four bytes. */
function glbOf(json: object, others: readonly (readonly [type: number, content: Uint8Array])[]): Uint8Array {
  const chunks = [[jsonChunk, encoded(json)] as const, ...others];
  const padded = (content: Uint8Array) => Math.ceil(content.length / 4) * 4;
  const length = chunks.reduce((sum, [, content]) => sum + 8 + padded(content), 12);
  const file = new Uint8Array(length);
  const view = new DataView(file.buffer);
  [magic, 2, length].forEach((word, i) => {
    view.setUint32(4 * i, word, true);
  });
  let place = 12;
  for (const [type, content] of chunks) {
    view.setUint32(place, padded(content), true);
    view.setUint32(place + 4, type, true);
    // JSON is padded with spaces, other chunks with zeros.
    if (type === jsonChunk) file.fill(0x20, place + 8, place + 8 + padded(content));
    file.set(content, place + 8);
    place += 8 + padded(content);
  }
  return file;
}

function chunksOf(glb: unknown): { json: Record<string, unknown>; others: [number, Uint8Array][] } {
  const bytes = bytesOfFile("glb", glb, "the bytes of a GLB file");
  const corrupt = (found: string) =>
    failure("CORRUPT_FILE", "glb", found, "a complete GLB file", "Pass the aligned file unchanged.");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== magic)
    throw corrupt(`${bytes.length} bytes without a GLB header`);
  const [version, length] = [view.getUint32(4, true), view.getUint32(8, true)];
  if (version !== 2) {
    throw failure("UNSUPPORTED_FORMAT", "glb", `glTF ${version}`, "glTF 2", "Convert it to glTF 2 first.");
  }
  if (length > bytes.length) throw corrupt(`${bytes.length} bytes of ${length}`);
  const chunks: [number, Uint8Array][] = [];
  for (let place = 12; place + 8 <= length; ) {
    const end = place + 8 + view.getUint32(place, true);
    if (end > length) throw corrupt(`a chunk up to byte ${end} of ${length}`);
    chunks.push([view.getUint32(place + 4, true), bytes.subarray(place + 8, end)]);
    place = end;
  }
  const [first, ...others] = chunks;
  if (first?.[0] !== jsonChunk) throw corrupt("no JSON chunk at the beginning");
  return { json: parsed(first[1], corrupt), others };
}

function parsed(bytes: Uint8Array, corrupt: (found: string) => Error): Record<string, unknown> {
  let json: unknown;
  try {
    json = JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    throw corrupt("invalid JSON");
  }
  if (!isRecord(json)) throw corrupt(`${describe(json)} as its JSON`);
  return json;
}

/** JSON as bytes. What callers add to it, metrics and names, may be anything. */
function encoded(json: unknown): Uint8Array {
  try {
    return new TextEncoder().encode(JSON.stringify(json));
  } catch {
    const found = "a value that JSON cannot hold";
    throw failure("INVALID_ARGUMENT", "options.metrics", found, "metrics as in a result", "Pass those of a result.");
  }
}
