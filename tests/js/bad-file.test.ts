/** Bad files: a typed error that says what to do. */
import { refusesInputs } from "../support/bad-input.js";
import type { Refusals } from "../support/errors.js";
import { glb, glbOf, gltfBuffer, gltfJson, npy, png } from "../support/files.js";
import { mesh, view } from "../support/scene.js";

const { width, height, depth, mask } = view;
const hostile = Buffer.alloc(100);
hostile.write("glTF", "latin1");
hostile.writeUInt32LE(2, 4);
hostile.writeUInt32LE(0xffffffff, 8);
hostile.writeUInt32LE(0xfffffff0, 12);
hostile.write("JSON", 16, "latin1");
/** A GLB whose geometry is there in compressed form only. */
function compressedBy(extension: string): Uint8Array {
  const plain = gltfJson(mesh);
  const isDraco = extension.startsWith("KHR");
  const primitive = {
    ...plain.meshes[0]?.primitives[0],
    extensions: { [extension]: { bufferView: 0, attributes: {} } },
  };
  const bufferViews = plain.bufferViews.map((view) => ({
    ...view,
    buffer: 1,
    extensions: { [extension]: { ...view, buffer: 0, mode: "ATTRIBUTES", count: 1, byteStride: 12 } },
  }));
  const changes = isDraco
    ? { meshes: [{ primitives: [primitive] }], accessors: plain.accessors.map(({ bufferView: _, ...rest }) => rest) }
    : {
        bufferViews,
        buffers: [...plain.buffers, { byteLength: 1e6, extensions: { [extension]: { fallback: true } } }],
      };
  const names = { extensionsUsed: [extension], extensionsRequired: [extension] };
  return glbOf({ ...plain, ...changes, ...names }, gltfBuffer(mesh));
}
const draco = compressedBy("KHR_draco_mesh_compression");
const meshopt = compressedBy("EXT_meshopt_compression");
const external = Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "mesh.bin" })));
const claims = { ...gltfJson(mesh), accessors: gltfJson(mesh).accessors.map((a) => ({ ...a, count: 2 ** 31 })) };
const bytes = new Uint8Array(width * height).fill(80);
const sized = { width: undefined, height: undefined };

const files: Refusals<object> = {
  "8-bit PNG depth: EIGHT_BIT_DEPTH depth": [{ ...sized, depth: png(bytes, width, height) }, /8-bit PNG/],
  "8-bit NPY depth: EIGHT_BIT_DEPTH depth": [{ ...sized, depth: npy(bytes, height, width) }, /8-bit/],
  "depth of no known format: UNSUPPORTED_FORMAT depth": [
    { ...sized, depth: Buffer.from("BM a bitmap") },
    /16-bit grey PNG, a \.npy array, or a \.npz/,
  ],
  "empty depth file: UNSUPPORTED_FORMAT depth": [{ ...sized, depth: new Uint8Array(0) }],
  "truncated depth: CORRUPT_FILE depth": [{ ...sized, depth: npy(depth, height, width).slice(0, 5000) }],
  "a depth file of another size than stated: SIZE_MISMATCH depth": [
    { depth: npy(depth, height, width), width: 1, height: 2 },
    /160 × 120.*1 × 2/,
  ],
  "truncated mask: CORRUPT_FILE mask": [{ mask: png(mask, width, height).slice(0, 60) }],
  "a mask file of another size: SIZE_MISMATCH mask": [{ mask: png(new Uint8Array(6).fill(1), 3, 2) }, /3 × 2 pixels/],
  "RLE that does not fill its size: CORRUPT_FILE mask.counts": [{ mask: { size: [120, 160], counts: [5, 5] } }],
  "a JPEG mask: UNSUPPORTED_FORMAT mask": [{ mask: Buffer.from("\xff\xd8\xff\xe0 JFIF", "latin1") }, /PNG/],
  "a GLB that claims 4 GB: FILE_TOO_LARGE mesh": [{ mesh: hostile }, /claims 4294967295 bytes; the file has 100/],
  "truncated GLB: CORRUPT_FILE mesh": [{ mesh: glb(mesh).slice(0, 5000) }],
  "accessors that claim too much: FILE_TOO_LARGE mesh": [{ mesh: glbOf(claims, gltfBuffer(mesh)) }],
  "a Draco-compressed GLB: COMPRESSED_MESH mesh": [{ mesh: draco }, /KHR_draco_mesh_compression.*gltf-transform/],
  "a meshopt-compressed GLB: COMPRESSED_MESH mesh": [{ mesh: meshopt }, /EXT_meshopt_compression.*gltf-transform/],
  "a .gltf without its buffer: INVALID_ARGUMENT mesh.resources": [{ mesh: external }, /mesh\.bin/],
  "a mesh of no known format: UNSUPPORTED_FORMAT mesh": [{ mesh: Buffer.from("hello, world") }],
  "an unknown mesh format: INVALID_OPTION mesh.format": [{ mesh: { bytes: glb(mesh), format: "fbx" } }, /fbx/],
  "an empty mesh file: UNSUPPORTED_FORMAT mesh": [{ mesh: new Uint8Array(0) }],
};

refusesInputs(files);
