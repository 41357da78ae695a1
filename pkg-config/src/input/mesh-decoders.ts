/** Decoders of compressed geometry. Callers may bring those of other versions: the objects of their libraries fit as they are. */
import type { ReadMeshOptions } from "../modules/exports.js";

/** Rewrites a mesh file, and the options of its reader, without the compression of its geometry. */
export type DecodeGeometry = (bytes: Uint8Array, options: ReadMeshOptions) => [Uint8Array, ReadMeshOptions];

/** Decoders of compressed geometry. */
export interface MeshDecoders {
  meshoptDecoder?: MeshoptDecoder | undefined;
  dracoDecoder?: DracoDecoderModule | undefined;
}

/** Decodes meshopt: the `MeshoptDecoder` of the npm package `meshoptimizer`, and of three.js. */
export interface MeshoptDecoder {
  /** Settles when the decoder is ready. */
  readonly ready: PromiseLike<unknown>;
  /** Whether the runtime supports it. */
  readonly supported: boolean;
  /** Decodes a buffer view of glTF into `target`, `count` elements of `size` bytes. */
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
  /** The class of decoders. */
  readonly Decoder: DracoClass<DracoDecoder>;
  /** The class of compressed bytes. */
  readonly DecoderBuffer: DracoClass<DracoBuffer>;
  /** The class of decoded meshes. */
  readonly Mesh: DracoClass<DracoMesh>;
  /** The memory of the module. */
  readonly HEAPF32: Float32Array;
  /** Signed bytes. */
  readonly DT_INT8: number;
  /** Unsigned bytes. */
  readonly DT_UINT8: number;
  /** Signed numbers of 16 bits. */
  readonly DT_INT16: number;
  /** Unsigned numbers of 16 bits. */
  readonly DT_UINT16: number;
  /** Unsigned numbers of 32 bits. */
  readonly DT_UINT32: number;
  /** Floats of 32 bits. */
  readonly DT_FLOAT32: number;
  /** Allocates memory. */
  _malloc(bytes: number): number;
  /** Frees allocated memory. */
  _free(pointer: number): void;
  /** Frees an object of the classes. */
  destroy(object: object): void;
}

/** A decoder of a {@link DracoDecoderModule}. */
export interface DracoDecoder {
  /** Decodes a mesh. */
  DecodeBufferToMesh(buffer: DracoBuffer, mesh: DracoMesh): DracoStatus;
  /** Copies the indices to the memory. */
  GetTrianglesUInt32Array(mesh: DracoMesh, bytes: number, pointer: number): unknown;
  /** An attribute, by its number in the file. */
  GetAttributeByUniqueId(mesh: DracoMesh, id: number): DracoAttribute;
  /** Copies the values of an attribute to the memory. */
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
  /** Sets the compressed bytes. */
  Init(data: Int8Array, bytes: number): void;
}

/** A mesh of a {@link DracoDecoderModule}, with what its published types demand of one. */
export interface DracoMesh {
  /** The address in the module's memory. */
  readonly ptr: number;
  /** The number of attributes. */
  num_attributes(): number;
  /** The number of vertices. */
  num_points(): number;
  /** The number of triangles. */
  num_faces(): number;
}

/** An attribute of a {@link DracoMesh}. */
export interface DracoAttribute {
  /** The number of values per vertex. */
  num_components(): number;
}

/** A class of a {@link DracoDecoderModule}. */
export interface DracoClass<T> {
  /** Makes an object. */
  new (): T;
}

/** The outcome of a {@link DracoDecoder}. */
export interface DracoStatus {
  /** Whether decoding succeeded. */
  ok(): boolean;
  /** The reason for a failure. */
  error_msg(): string;
}
