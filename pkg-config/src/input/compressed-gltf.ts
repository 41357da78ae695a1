/** glTF files whose geometry is compressed: rewritten without the compression, by the caller's decoders. */
import type { ErrorParts } from "../values/error.js";
import type { DecodeGeometry, DracoDecoderModule, MeshoptDecoder } from "./mesh-decoders.js";

// This file throws what the modules throw, plain objects, and imports nothing: bundlers would put what it shares with the
// readers into a file of its own, which everybody loads.

type Json = Record<string, unknown>;

const meshoptNames = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
const dracoName = "KHR_draco_mesh_compression";

/** Maximum number of bytes of all decoded data, as of all buffers of a file in the reader. */
const MAX_BYTES = 2 ** 30;

/** meshopt describes 256 elements of zeros with a quarter of a byte for each of their bytes; nothing is shorter. */
const MAX_MESHOPT_RATIO = 1024;

/** The strides that the modes and filters of meshopt can have. */
const meshoptModes: Record<string, (stride: number) => boolean> = {
  ATTRIBUTES: (stride) => stride % 4 === 0 && stride <= 256,
  TRIANGLES: (stride) => stride === 2 || stride === 4,
  INDICES: (stride) => stride === 2 || stride === 4,
};
const meshoptFilters: typeof meshoptModes = {
  OCTAHEDRAL: (stride) => stride === 4 || stride === 8,
  QUATERNION: (stride) => stride === 8,
  EXPONENTIAL: (stride) => stride % 4 === 0,
  COLOR: (stride) => stride === 4 || stride === 8,
};

/** The attributes that the reader reads: others stay compressed. */
const attributesRead = /^(POSITION|(TEXCOORD|COLOR|JOINTS|WEIGHTS)_\d+)$/;
/** The names of component types in Draco, and their bytes. */
const dracoTypes = new Map<unknown, readonly [name: DracoType, bytes: number]>([
  [5120, ["DT_INT8", 1]],
  [5121, ["DT_UINT8", 1]],
  [5122, ["DT_INT16", 2]],
  [5123, ["DT_UINT16", 2]],
  [5125, ["DT_UINT32", 4]],
  [5126, ["DT_FLOAT32", 4]],
]);
type DracoType = Extract<keyof DracoDecoderModule, `DT_${string}`>;

const componentsOf: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

/**
 * A function that decodes the geometry of glTF files, also of binary ones. It returns a damaged container as it is: the reader
 * names what is wrong with it. What is compressed for a decoder that is not there stays as it is.
 */
export async function geometryDecoder(
  meshoptDecoder: MeshoptDecoder | undefined,
  dracoDecoder: DracoDecoderModule | undefined,
): Promise<DecodeGeometry> {
  const problem = await problemOf(meshoptDecoder, dracoDecoder);
  return (bytes, options) => {
    if (problem !== undefined) throw problem;
    const container = split(bytes);
    if (container === undefined) return [bytes, options];
    const gltf = new CompressedGltf(container, options.resources ?? {});
    // Objects of JSON may lack a conversion to text or be too deep for one.
    return corruptIfThrown("glTF", "cannot be rewritten", () => {
      if (meshoptDecoder) gltf.decodeMeshopt(meshoptDecoder);
      if (dracoDecoder) gltf.decodeDraco(dracoDecoder);
      return [gltf.text(), { ...options, format: "gltf", resources: gltf.resources }];
    });
  };
}

/** Why one of the decoders cannot be used. */
async function problemOf(
  meshopt: MeshoptDecoder | undefined,
  draco: DracoDecoderModule | undefined,
): Promise<ErrorParts | undefined> {
  const refused = (argument: string, found: string, expected: string): ErrorParts => {
    return { code: "INVALID_ARGUMENT", argument, found, expected, remedy: "Pass the object of the library." };
  };
  try {
    if (meshopt) {
      const isDecoder = meshopt.supported && typeof meshopt.decodeGltfBuffer === "function";
      if (!isDecoder) throw new Error("it is no decoder, or not supported here");
      await meshopt.ready;
    }
  } catch (cause) {
    const expected = "MeshoptDecoder of the npm package meshoptimizer";
    return refused("options.meshoptDecoder", `a decoder that cannot start: ${textOf(cause)}`, expected);
  }
  try {
    if (draco) {
      const { Decoder, DecoderBuffer, Mesh, _malloc, _free, destroy } = draco;
      const parts = [Decoder, DecoderBuffer, Mesh, _malloc, _free, destroy];
      if (!parts.every((part) => typeof part === "function")) throw new Error("it is no module with a decoder");
    }
  } catch (cause) {
    const expected = "the module that createDecoderModule() of the npm package draco3d returns, awaited";
    return refused("options.dracoDecoder", `a decoder that cannot start: ${textOf(cause)}`, expected);
  }
  return undefined;
}

interface Container {
  json: Json;
  binary?: Uint8Array | undefined;
}

function split(bytes: Uint8Array): Container | undefined {
  try {
    const text = (part: Uint8Array) => JSON.parse(new TextDecoder().decode(part));
    if (bytes[0] !== 0x67) return { json: recordOf(text(bytes)) };
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    // The header has 12 bytes, that of a chunk 8.
    const end = 20 + view.getUint32(12, true);
    const hasBinary = end + 8 <= bytes.length && view.getUint32(end + 4, true) === 0x004e4942;
    const binary = hasBinary ? bytes.subarray(end + 8, end + 8 + view.getUint32(end, true)) : undefined;
    return { json: recordOf(text(bytes.subarray(20, end))), binary };
  } catch {
    return undefined;
  }
}

/** The document of a file, whose geometry is decoded in place. */
class CompressedGltf {
  readonly #json: Json;
  readonly #binary: Uint8Array | undefined;
  /** The files of the caller, and what has been decoded. */
  readonly resources: Record<string, Uint8Array | ArrayBuffer>;
  readonly #files = new Map<unknown, Uint8Array>();
  #added = 0;
  #bytes = 0;
  /** The bytes of the buffers so far, and of the compressed parts of them. */
  #available = 0;
  #used = 0;

  constructor({ json, binary }: Container, resources: Readonly<Record<string, Uint8Array | ArrayBuffer>>) {
    this.#json = json;
    this.#binary = binary;
    this.resources = { ...resources };
  }

  /** Decodes the buffer views of meshopt. */
  decodeMeshopt(decoder: MeshoptDecoder): void {
    for (const [i, view] of this.#list("bufferViews").entries()) {
      const extensions = recordOf(recordOf(view).extensions);
      const extension = meshoptNames.map((name) => extensions[name]).find(isRecord);
      if (!isRecord(view) || extension === undefined) continue;
      const bytes = this.#decodedView(decoder, extension, view, `buffer view ${i}`);
      Object.assign(view, { buffer: this.#addBuffer(bytes), byteOffset: 0, byteLength: bytes.length, extensions: {} });
    }
    this.#removeExtensions(meshoptNames);
  }

  /** Decodes the primitives of Draco. */
  decodeDraco(module: DracoDecoderModule): void {
    // Several parts may be one and the same, with different materials.
    const parts = new Map<string, Json>();
    for (const mesh of this.#list("meshes")) {
      for (const primitive of listOf(recordOf(mesh).primitives)) {
        const { [dracoName]: extension, ...extensions } = recordOf(recordOf(primitive).extensions);
        if (!isRecord(primitive) || !isRecord(extension)) continue;
        const { attributes, indices, mode } = primitive;
        const key = JSON.stringify([extension, attributes, indices, mode]);
        const part = parts.get(key) ?? this.#decodedPart(module, extension, primitive);
        parts.set(key, part);
        Object.assign(primitive, part, { extensions });
      }
    }
    this.#removeExtensions([dracoName]);
  }

  /** The document as a `.gltf`. */
  text(): Uint8Array {
    const [first] = this.#list("buffers");
    if (this.#binary !== undefined && isRecord(first) && first.uri === undefined) {
      first.uri = this.#addResource(this.#binary);
    }
    return new TextEncoder().encode(JSON.stringify(this.#json));
  }

  #decodedView(decoder: MeshoptDecoder, extension: Json, view: Json, what: string): Uint8Array {
    const { mode, filter = "NONE" } = extension;
    const [count, stride] = [whole(extension.count), whole(extension.byteStride)];
    const isMode = typeof mode === "string" && Object.hasOwn(meshoptModes, mode) && meshoptModes[mode]?.(stride);
    const isFilter = Object.hasOwn(meshoptFilters, String(filter)) && meshoptFilters[String(filter)]?.(stride);
    const isWhole = count >= 0 && (mode !== "TRIANGLES" || count % 3 === 0);
    if (!(stride > 0 && isMode && isWhole && (filter === "NONE" || (mode === "ATTRIBUTES" && isFilter)))) {
      const found = `${what} as ${json(extension)}`;
      throw corrupt(found, "a mode and a filter of meshopt, with counts and strides that they can have");
    }
    const size = count * stride;
    if (!(whole(view.byteLength) <= size) || (view.byteStride !== undefined && view.byteStride !== stride)) {
      const found = `${what} of ${json(view.byteLength)} bytes, ${json(view.byteStride ?? stride)} apart`;
      throw corrupt(found, `those of its compressed form: ${size}, ${stride} apart`);
    }
    const source = this.#bytesOf(extension, what);
    if (!(size <= MAX_MESHOPT_RATIO * source.length)) {
      throw corrupt(`${what} of ${size} bytes in ${source.length}`, "as many as meshopt can compress so far");
    }
    this.#count(size);
    return corruptIfThrown(what, "meshoptDecoder cannot decode", () => {
      const target = new Uint8Array(size);
      decoder.decodeGltfBuffer(target, count, stride, source, String(mode), String(filter));
      return target;
    });
  }

  /** Decodes a primitive; returns what changes in it. */
  #decodedPart(module: DracoDecoderModule, extension: Json, primitive: Json): Json {
    const { attributes, indices, mode = 4 } = primitive;
    // The triangles of strips come as triangles.
    if (mode !== 4 && mode !== 5) throw corrupt(`primitives of mode ${json(mode)} as Draco`, "modes 4 or 5, triangles");
    const what = `Draco's buffer view ${json(extension.bufferView)}`;
    const source = this.#bytesOf(this.#at("bufferViews", extension.bufferView), what);
    return corruptIfThrown(what, "dracoDecoder cannot decode", () => {
      const [decoder, buffer, mesh] = [new module.Decoder(), new module.DecoderBuffer(), new module.Mesh()];
      try {
        buffer.Init(new Int8Array(source.buffer, source.byteOffset, source.length), source.length);
        const status = decoder.DecodeBufferToMesh(buffer, mesh);
        if (!status.ok()) throw new Error(status.error_msg());
        const [points, corners] = [mesh.num_points(), 3 * mesh.num_faces()];
        this.#count(4 * points);
        const check = (name: string, count: unknown, expected: number) => {
          if (count !== expected) throw corrupt(`${name} of ${json(count)} elements`, `${expected}, as in ${what}`);
        };
        const add = (accessor: Json, size: number, fill: (pointer: number) => unknown): number => {
          this.#count(size);
          const data = this.#addBuffer(copied(module, size, fill));
          const bufferView = this.#push("bufferViews", { buffer: data, byteLength: size });
          return this.#push("accessors", { ...accessor, bufferView, byteOffset: 0 });
        };
        if (indices !== undefined && mode === 4) check("indices", this.#at("accessors", indices).count, corners);
        const changed = { ...recordOf(attributes) };
        for (const [name, id] of Object.entries(recordOf(extension.attributes))) {
          if (!attributesRead.test(name)) continue;
          const accessor = this.#at("accessors", changed[name]);
          const attribute = decoder.GetAttributeByUniqueId(mesh, whole(id));
          const components = componentsOf[String(accessor.type)];
          const [type, bytes] = dracoTypes.get(accessor.componentType) ?? [];
          // A null pointer of C++ is an object here.
          const isThere = whole(id) >= 0 && (attribute as { ptr?: number }).ptr !== 0;
          if (!isThere || type === undefined || bytes === undefined || attribute.num_components() !== components) {
            const found = `${name} as ${json(accessor.type)} of ${json(accessor.componentType)}`;
            throw corrupt(found, `an attribute that ${what} has, of as many components`);
          }
          check(name, accessor.count, points);
          const size = points * components * bytes;
          changed[name] = add(accessor, size, (pointer) =>
            decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, module[type], size, pointer),
          );
        }
        const accessor = { componentType: 5125, type: "SCALAR", count: corners };
        const triangles = add(accessor, 4 * corners, (pointer) =>
          decoder.GetTrianglesUInt32Array(mesh, 4 * corners, pointer),
        );
        return { attributes: changed, indices: triangles, mode: 4 };
      } finally {
        for (const object of [mesh, buffer, decoder]) module.destroy(object);
      }
    });
  }

  /** The bytes of a buffer view, compressed or not. */
  #bytesOf(view: Json, what: string): Uint8Array {
    const bytes = this.#bufferAt(view.buffer);
    const [start, length] = [whole(view.byteOffset ?? 0), whole(view.byteLength)];
    if (start + length <= bytes.length) {
      this.#used += length;
      // Or a small file could make the decoder work for hours.
      if (this.#used <= 2 * this.#available) return bytes.subarray(start, start + length);
      throw corrupt(`${this.#used} compressed bytes in buffers of ${this.#available}`, "parts that do not overlap");
    }
    const found = `${what} at ${json(view.byteOffset ?? 0)}, ${json(view.byteLength)} bytes long`;
    throw corrupt(found, `a part of buffer ${json(view.buffer)}, which has ${bytes.length} bytes`);
  }

  #bufferAt(index: unknown): Uint8Array {
    const { uri } = this.#at("buffers", index);
    const own = index === 0 && uri === undefined ? this.#binary : undefined;
    if (own === undefined && typeof uri !== "string")
      throw corrupt(`buffer ${json(index)} without data`, "compressed data");
    const known = this.#files.get(uri);
    if (known !== undefined) return known;
    const bytes = own ?? this.#fileAt(uri as string);
    this.#files.set(uri, bytes);
    this.#available += bytes.length;
    return bytes;
  }

  #fileAt(uri: string): Uint8Array {
    try {
      const [, base64] = /^data:[^,]*;base64,(.*)$/s.exec(uri) ?? [];
      if (base64 !== undefined) return Uint8Array.from(atob(base64), (byte) => byte.charCodeAt(0));
      const file = this.resources[uri] ?? this.resources[decodeURIComponent(uri)];
      if (ArrayBuffer.isView(file)) return new Uint8Array(file.buffer, file.byteOffset, file.byteLength);
      if (file !== undefined && "byteLength" in file) return new Uint8Array(file);
    } catch {
      // Broken base64, a name with broken escapes, or something else than bytes.
    }
    const found = `no bytes for ${json(uri)}`;
    const [argument, expected] = ["options.resources", "the bytes of every external file"];
    throw { code: "INVALID_ARGUMENT", argument, found, expected, remedy: "Pass them in resources." } as ErrorParts;
  }

  #addBuffer(bytes: Uint8Array): number {
    return this.#push("buffers", { byteLength: bytes.length, uri: this.#addResource(bytes) });
  }

  /** Adds a file to the resources; returns its name. */
  #addResource(bytes: Uint8Array): string {
    const name = `sim3align:${this.#added++}`;
    this.resources[name] = bytes;
    return name;
  }

  #push(name: string, item: Json): number {
    const list = this.#list(name);
    this.#json[name] = list;
    return list.push(item) - 1;
  }

  /** Counts decoded bytes before they are there. */
  #count(bytes: number): void {
    this.#bytes += bytes;
    if (this.#bytes <= MAX_BYTES) return;
    const found = `${this.#bytes} bytes of geometry`;
    const [expected, remedy] = [`at most ${MAX_BYTES}`, "Simplify the mesh."];
    throw { code: "FILE_TOO_LARGE", argument: "mesh", found, expected, remedy } as ErrorParts;
  }

  #at(list: string, index: unknown): Json {
    const items = this.#list(list);
    const item = items[whole(index)];
    if (isRecord(item)) return item;
    throw corrupt(`no object ${json(index)} of ${list}`, `indices below ${items.length}`);
  }

  /** A list of the document. */
  #list(name: string): unknown[] {
    return listOf(this.#json[name]);
  }

  #removeExtensions(names: readonly string[]): void {
    for (const list of ["extensionsUsed", "extensionsRequired"]) {
      this.#json[list] = this.#list(list).filter((name) => !names.includes(String(name)));
    }
  }
}

/** Bytes that a decoder writes to the memory of its module. */
function copied(module: DracoDecoderModule, size: number, fill: (pointer: number) => unknown): Uint8Array {
  const pointer = module._malloc(size);
  if (pointer === 0) throw new Error("its memory is exhausted");
  try {
    if (fill(pointer) === false) throw new Error("it has less data than it says");
    // Only now: the memory may have grown.
    return new Uint8Array(module.HEAPF32.buffer, pointer, size).slice();
  } finally {
    module._free(pointer);
  }
}

/** Errors name the mesh, as those of the reader. */
const corrupt = (found: string, expected: string): ErrorParts => {
  return { code: "CORRUPT_FILE", argument: "mesh", found, expected, remedy: "Export the mesh again." };
};

/** A part of a document, for errors. */
const json = (value: unknown): string => JSON.stringify(value)?.slice(0, 160) ?? "nothing";

/** Translates what decoders and engines throw, but for our own errors and for exhausted memory. */
function corruptIfThrown<T>(what: string, problem: string, work: () => T): T {
  try {
    return work();
  } catch (cause) {
    const { message, remedy } = recordOf(cause);
    if (remedy !== undefined || /array buffer allocation/i.test(textOf(message))) throw cause;
    throw corrupt(`${what}, which ${problem}: ${textOf(cause)}`, "complete data");
  }
}

/** The text of anything that was thrown. */
function textOf(thrown: unknown): string {
  try {
    return String(thrown);
  } catch {
    return "something without a text";
  }
}

/** A whole number of a document; NaN, with which no comparison holds, for anything else. */
const whole = (value: unknown): number =>
  Number.isSafeInteger(value) && (value as number) >= 0 ? (value as number) : Number.NaN;

const isRecord = (value: unknown): value is Json =>
  typeof value === "object" && value !== null && !Array.isArray(value);

const recordOf = (value: unknown): Json => (isRecord(value) ? value : {});

const listOf = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
