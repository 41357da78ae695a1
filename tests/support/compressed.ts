/** Meshes as compressed glTF, by the encoders of meshoptimizer and Draco. */
import draco3d from "draco3d";
import { MeshoptEncoder } from "meshoptimizer/encoder";
import { glbOf, gltfJson } from "./files.js";
import type { Mesh } from "./scene.js";

export type Json = Record<string, unknown>;

/** A glTF file in two parts. Its JSON may be changed. */
export interface Gltf {
  json: ReturnType<typeof gltfJson> & Json;
  buffer: Uint8Array;
}

export const glbFrom = ({ json, buffer }: Gltf) => glbOf(json, buffer);

/** The JSON of a mesh of one buffer that holds what is compressed. */
function documentOf(mesh: Mesh, extension: string, parts: readonly Uint8Array[]): Gltf {
  const buffer = Buffer.concat(parts);
  const json = { ...gltfJson(mesh), extensionsUsed: [extension], extensionsRequired: [extension] };
  json.buffers = [{ byteLength: buffer.length }];
  return { json, buffer };
}

await MeshoptEncoder.ready;
const bytesOf = (array: Float32Array | Uint32Array | Int16Array) =>
  new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

/**
 * A mesh compressed with meshopt.
 * @param isQuantised whether positions are normalised integers of 16 bits, as most programs write them
 */
export function meshoptGltf(mesh: Mesh, extension: string, isQuantised: boolean): Gltf {
  const vertices = mesh.positions.length / 3;
  // Four numbers per vertex: their stride is a multiple of four bytes.
  const quantised = new Int16Array(4 * vertices);
  const largest = mesh.positions.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  for (const [i, x] of mesh.positions.entries())
    quantised[4 * Math.floor(i / 3) + (i % 3)] = Math.round((x / largest) * 32767);
  const positions = bytesOf(isQuantised ? quantised : mesh.positions);
  const version = extension.startsWith("KHR") ? 1 : 0;
  const stride = isQuantised ? 8 : 12;
  const views = [
    { mode: "ATTRIBUTES", count: vertices, byteStride: stride, bytes: positions },
    { mode: "TRIANGLES", count: mesh.indices.length, byteStride: 4, bytes: bytesOf(mesh.indices) },
  ];
  const parts = views.map(({ mode, count, byteStride, bytes }) =>
    MeshoptEncoder.encodeGltfBuffer(bytes, count, byteStride, mode, version),
  );
  const { json, buffer } = documentOf(mesh, extension, parts);
  json.bufferViews = views.map(({ bytes, ...form }, i) => ({
    buffer: 1,
    byteOffset: i * positions.length,
    byteLength: bytes.length,
    ...(form.mode === "ATTRIBUTES" ? { byteStride: stride } : {}),
    extensions: {
      [extension]: { buffer: 0, byteOffset: i * (parts[0]?.length ?? 0), byteLength: parts[i]?.length, ...form },
    },
  }));
  // A buffer without data, of the uncompressed size.
  json.buffers.push({
    byteLength: positions.length + mesh.indices.byteLength,
    extensions: { [extension]: { fallback: true } },
  } as never);
  if (isQuantised) {
    json.nodes = [{ mesh: 0, scale: [largest, largest, largest] } as never];
    Object.assign(json.accessors[0] ?? {}, { componentType: 5122, normalized: true, min: undefined, max: undefined });
    json.extensionsUsed = json.extensionsRequired = [extension, "KHR_mesh_quantization"];
  }
  return { json, buffer };
}

const encoders = await draco3d.createEncoderModule();

/** A mesh compressed with Draco, in the order of its vertices and triangles, whose vertices all have one colour. */
export function dracoGltf(mesh: Mesh, [red, green, blue]: readonly [number, number, number]): Gltf {
  const vertices = mesh.positions.length / 3;
  const [builder, made, encoder, data] = [
    new encoders.MeshBuilder(),
    new encoders.Mesh(),
    new encoders.Encoder(),
    new encoders.DracoInt8Array(),
  ];
  const colors = new Uint8Array(3 * vertices).map((_, i) => [red, green, blue][i % 3] ?? 0);
  builder.AddFacesToMesh(made, mesh.indices.length / 3, mesh.indices);
  // Attributes are numbered from 0.
  builder.AddFloatAttribute(made, encoders.POSITION as never, vertices, 3, mesh.positions);
  builder.AddUInt8Attribute(made, encoders.COLOR as never, vertices, 3, colors);
  encoder.SetEncodingMethod(encoders.MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(encoders.POSITION, 16);
  const length = encoder.EncodeMeshToDracoBuffer(made, data);
  const values = data as unknown as { GetValue(index: number): number };
  const bytes = Uint8Array.from({ length }, (_, i) => values.GetValue(i));
  for (const object of [builder, made, encoder, data]) encoders.destroy(object);
  const { json, buffer } = documentOf(mesh, "KHR_draco_mesh_compression", [bytes]);
  json.bufferViews = [{ buffer: 0, byteOffset: 0, byteLength: length }];
  json.accessors = [
    { componentType: 5126, count: vertices, type: "VEC3" },
    { componentType: 5125, count: mesh.indices.length, type: "SCALAR" },
    { componentType: 5121, normalized: true, count: vertices, type: "VEC3" },
  ] as never;
  const attributes = { POSITION: 0, COLOR_0: 2 };
  const extension = { bufferView: 0, attributes: { POSITION: 0, COLOR_0: 1 } };
  const primitive = { attributes, indices: 1, extensions: { KHR_draco_mesh_compression: extension } };
  json.meshes = [{ primitives: [primitive] }];
  return { json, buffer };
}
