/** Decoders of compressed geometry, which callers bring: the objects of their libraries fit as they are. */
import type { ReadMeshOptions } from "../wasm/formats.js";

/** Rewrites a mesh file, and the options of its reader, without the compression of its geometry. */
export type DecodeGeometry = (bytes: Uint8Array, options: ReadMeshOptions) => [Uint8Array, ReadMeshOptions];

/** Decodes meshopt: the `MeshoptDecoder` of the npm package `meshoptimizer`, and of three.js. */
export interface MeshoptDecoder {
  readonly ready: PromiseLike<unknown>;
  readonly supported: boolean;
  decodeGltfBuffer(
    target: Uint8Array,
    count: number,
    size: number,
    source: Uint8Array,
    mode: string,
    filter?: string,
  ): void;
}

/** Decodes Draco: what `createDecoderModule()` of the npm package `draco3d` (or `draco3dgltf`) resolves to. */
export interface DracoDecoderModule {
  readonly Decoder: new () => DracoDecoder;
  readonly DecoderBuffer: new () => DracoBuffer;
  readonly Mesh: new () => DracoMesh;
  readonly HEAPF32: Float32Array;
  readonly DT_INT8: number;
  readonly DT_UINT8: number;
  readonly DT_INT16: number;
  readonly DT_UINT16: number;
  readonly DT_UINT32: number;
  readonly DT_FLOAT32: number;
  _malloc(bytes: number): number;
  _free(pointer: number): void;
  destroy(object: object): void;
}

/** A decoder of a {@link DracoDecoderModule}. */
export interface DracoDecoder {
  DecodeBufferToMesh(buffer: DracoBuffer, mesh: DracoMesh): { ok(): boolean; error_msg(): string };
  GetTrianglesUInt32Array(mesh: DracoMesh, bytes: number, pointer: number): unknown;
  GetAttributeByUniqueId(mesh: DracoMesh, id: number): DracoAttribute;
  GetAttributeDataArrayForAllPoints(
    mesh: DracoMesh,
    attribute: DracoAttribute,
    type: number,
    bytes: number,
    pointer: number,
  ): unknown;
}

/** Compressed bytes of a {@link DracoDecoderModule}. */
export interface DracoBuffer {
  Init(data: Int8Array, bytes: number): void;
}

/** A mesh of a {@link DracoDecoderModule}, with what its published types demand of one. */
export interface DracoMesh {
  readonly ptr: number;
  num_attributes(): number;
  num_points(): number;
  num_faces(): number;
}

/** An attribute of a {@link DracoMesh}. */
export interface DracoAttribute {
  num_components(): number;
}
