/** Growing glTF documents, which other files and meshes are added to. Nothing is decoded: indices are moved. */
import { describe, failure } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { oncePerKey, stringsIn } from "../values/validation.js";
import { binaryChunk, type GlbFile, padded } from "./glb-file.js";
import { bounds, type Mesh } from "./mesh.js";

type Json = Record<string, unknown>;

/**
 * The lists of a document, and the properties that have indices of their items: in glTF 2.0, in the extensions of Khronos
 * (KHR) and in some of several vendors (EXT). Paths are without the positions in lists and without `extensions`; `*` is a
 * name, `**` any number of names. An extension's list at the root has the name of the extension before its own.
 */
const references: Readonly<Record<string, readonly string[]>> = {
  accessors: [
    ...["meshes/primitives/indices", "meshes/primitives/attributes/*", "meshes/primitives/targets/*"],
    ...["nodes/EXT_mesh_gpu_instancing/attributes/*", "skins/inverseBindMatrices"],
    ...["animations/samplers/input", "animations/samplers/output"],
  ],
  // Accessors, sparse ones as well, images, and compressed primitives.
  bufferViews: ["**/bufferView"],
  cameras: ["nodes/camera"],
  images: ["textures/**source", "EXT_lights_image_based/lights/specularImages"],
  materials: ["meshes/primitives/**material", "materials/MSFT_lod/ids"],
  meshes: ["nodes/mesh"],
  nodes: ["nodes/children", "nodes/MSFT_lod/ids", "skins/joints", "skins/skeleton", "animations/channels/target/node"],
  samplers: ["textures/sampler"],
  skins: ["nodes/skin"],
  textures: ["**[tT]exture/index"],
  "KHR_lights_punctual/lights": ["nodes/KHR_lights_punctual/light"],
  "KHR_materials_variants/variants": ["meshes/primitives/KHR_materials_variants/mappings/variants"],
  "KHR_xmp_json_ld/packets": ["**/KHR_xmp_json_ld/packet"],
};
/** The extensions whose references, if they have any, are among these. */
const movable =
  /^(KHR_.*|EXT_(lights_image_based|materials_.*|mesh_gpu_instancing|meshopt_compression|texture_.*)|MSFT_(lod|texture_dds))$/;

const patterns = Object.entries(references).map(([list, paths]) => {
  const any = paths.map((path) => path.replace(/\*+/g, (stars) => (stars === "*" ? "[^/]+" : ".*")));
  return [list, new RegExp(`^(${any.join("|")})$`)] as const;
});

/** The list that the numbers at a path are indices of. */
const listOf = (path: string) => patterns.find(([, pattern]) => pattern.test(path))?.[0];

/** A growing document. */
export class GltfDocument {
  /** Lists, and what else extensions have at the root, by their paths. */
  readonly #content = new Map<string, unknown>();
  /** The buffers after that of the file. */
  readonly #buffers: unknown[] = [];
  readonly #binaries: Uint8Array[] = [];
  readonly #extensions = { extensionsUsed: new Set<string>(), extensionsRequired: new Set<string>() };
  #length = 0;

  /** Adds the content of a file; returns the indices of the nodes that its scene shows. */
  add({ json, chunks }: GlbFile): number[] {
    const start = this.#addBinary(chunks.find(([type]) => type === binaryChunk)?.[1] ?? new Uint8Array());
    const buffers = objectsOf(json, "buffers").map((buffer, i) => {
      const isInFile = i === 0 && buffer.uri === undefined;
      return isInFile ? { index: 0, start } : { index: this.#buffers.push(buffer), start: 0 };
    });
    const { asset, scene, scenes, buffers: _, extensionsUsed, extensionsRequired, extensions, extras, ...lists } = json;
    const parts = Object.entries(lists);
    const starts = new Map(Array.from(this.#content, ([path, list]) => [path, arrayOf(list).length]));
    if (starts.size > 0) checkMovable(extensions);
    for (const [extension, content] of Object.entries(isRecord(extensions) ? extensions : {})) {
      for (const [name, part] of Object.entries(isRecord(content) ? content : {}))
        parts.push([`${extension}/${name}`, part]);
    }
    const move = mover(starts, buffers);
    const nodes = move(shownNodes(json), "nodes/children") as number[];
    for (const [path, part] of parts.map(([path, part]) => [path, move(part, path)] as const)) {
      this.#content.set(path, joined(this.#content.get(path), part));
    }
    for (const name of stringsIn(extensionsUsed)) this.#extensions.extensionsUsed.add(name);
    for (const name of stringsIn(extensionsRequired)) this.#extensions.extensionsRequired.add(name);
    return nodes;
  }

  /** Adds an item to a list; returns its index. */
  push(list: string, item: object): number {
    const items = arrayOf(this.#content.get(list));
    this.#content.set(list, items);
    return items.push(item) - 1;
  }

  /** Adds a mesh; returns its index. */
  addMesh({ positions, indices }: Mesh, material?: number): number {
    const points = { bufferView: this.#addView(positions, 34962), componentType: 5126, type: "VEC3" };
    const POSITION = this.push("accessors", { ...points, count: positions.length / 3, ...bounds(positions) });
    const primitive: Json = { attributes: { POSITION } };
    if (indices !== null) {
      const bufferView = this.#addView(Uint32Array.from(indices), 34963);
      const corners = { bufferView, componentType: 5125, type: "SCALAR", count: indices.length };
      primitive.indices = this.push("accessors", corners);
    }
    if (material !== undefined) primitive.material = material;
    return this.push("meshes", { primitives: [primitive] });
  }

  /** Adds the values of an animation: numbers, or vectors of three or four; returns the index of their accessor. */
  addValues(values: readonly (readonly number[])[]): number {
    const [size = 1, numbers] = [values[0]?.length, Float32Array.from(values.flat())];
    const type = size === 1 ? "SCALAR" : `VEC${size}`;
    // Times need their range.
    const range = size === 1 ? { min: [Math.min(...numbers)], max: [Math.max(...numbers)] } : {};
    const bufferView = this.#addView(numbers);
    return this.push("accessors", { bufferView, componentType: 5126, type, count: values.length, ...range });
  }

  /** The file that shows these nodes. */
  finish(nodes: readonly number[]): { json: Json; chunks: GlbFile["chunks"] } {
    // The first buffer is that of the file, if there is any other.
    const binary = new Uint8Array(this.#buffers.length > 0 ? Math.max(this.#length, 4) : this.#length);
    let place = 0;
    for (const bytes of this.#binaries) {
      binary.set(bytes, place);
      place = padded(place + bytes.length);
    }
    const json: Json = { asset: { version: "2.0", generator: "sim3align" } };
    for (const [name, names] of Object.entries(this.#extensions)) if (names.size > 0) json[name] = [...names];
    Object.assign(json, { scene: 0, scenes: [{ nodes }] });
    const extensions: Record<string, Json> = {};
    for (const [path, part] of this.#content) {
      const [list, name] = path.split("/") as [string, string?];
      if (name !== undefined) extensions[list] = { ...extensions[list], [name]: part };
      else if (arrayOf(part).length > 0) json[list] = part;
    }
    if (Object.keys(extensions).length > 0) json.extensions = extensions;
    if (binary.length > 0) json.buffers = [{ byteLength: binary.length }, ...this.#buffers];
    return { json, chunks: binary.length > 0 ? [[binaryChunk, binary]] : [] };
  }

  #addView(array: Float32Array | Uint32Array, target?: number): number {
    const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
    const byteOffset = this.#addBinary(bytes);
    return this.push("bufferViews", { buffer: 0, byteOffset, byteLength: bytes.length, ...(target && { target }) });
  }

  /** Adds bytes to the buffer, at a multiple of four; returns where. */
  #addBinary(bytes: Uint8Array): number {
    const start = this.#length;
    this.#binaries.push(bytes);
    this.#length = padded(start + bytes.length);
    return start;
  }
}

/** @throws if these extensions may have references that would then point to other items */
function checkMovable(extensions: unknown): void {
  const other = Object.keys(isRecord(extensions) ? extensions : {}).find((name) => !movable.test(name));
  if (other === undefined) return;
  const remedy = `Remove ${other} from the file, or export its object alone.`;
  const expected = "extensions of Khronos, or others whose references are moved to the places of a joint file";
  throw failure("UNSUPPORTED_FORMAT", "glb", `the extension ${other}`, expected, remedy);
}

/** Moves the indices in a part of a file: to those of its lists, and of its buffers, in the document. */
function mover(starts: ReadonlyMap<string, number>, buffers: readonly { index: number; start: number }[]) {
  const start = (list: string) => starts.get(list) ?? 0;
  const startAt = oncePerKey((path: string) => start(listOf(path) ?? ""));
  const move = (value: unknown, path: string): unknown => {
    if (typeof value === "number") return value + startAt(path);
    // A JSON pointer to what is animated, such as /nodes/3/translation.
    if (typeof value === "string" && path.endsWith("/KHR_animation_pointer/pointer")) {
      return value.replace(
        /^\/(extensions\/\w+\/\w+|\w+)\/(\d+)/,
        (_, list: string, i: string) => `/${list}/${start(list.replace("extensions/", "")) + Number(i)}`,
      );
    }
    if (Array.isArray(value)) return value.map((item) => move(item, path));
    if (!isRecord(value)) return value;
    if (starts.size > 0) checkMovable(value.extensions);
    const inner = (name: string) => (name === "extensions" ? path : `${path}/${name}`);
    // Extras are the application's, and may contain anything.
    const entries = Object.entries(value).map(([name, part]) => [
      name,
      name === "extras" ? part : move(part, inner(name)),
    ]);
    const copy = Object.fromEntries(entries) as Json;
    // A view of a buffer, compressed or not.
    const buffer = path.startsWith("bufferViews") ? buffers[value.buffer as number] : undefined;
    if (buffer === undefined) return copy;
    return { ...copy, buffer: buffer.index, byteOffset: buffer.start + Number(value.byteOffset ?? 0) };
  };
  return move;
}

/** The content of two documents at a path: their lists together, and of what else there is the first. */
function joined(first: unknown, second: unknown): unknown {
  if (Array.isArray(first) && Array.isArray(second)) return first.concat(second);
  return isRecord(first) && isRecord(second) ? { ...second, ...first } : (first ?? second);
}

const arrayOf = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);

/** The objects of an optional list of a document. */
export function objectsOf(json: Json, name: string): Json[] {
  const list = json[name] ?? [];
  if (Array.isArray(list) && list.every(isRecord)) return list;
  throw failure("CORRUPT_FILE", "glb", `${describe(list)} as its ${name}`, "a list of objects", "Export it again.");
}

/** The nodes that the scene of a document shows; without a scene, those without a parent. */
export function shownNodes(json: Json): number[] {
  const scene = objectsOf(json, "scenes")[typeof json.scene === "number" ? json.scene : 0];
  if (scene !== undefined) return arrayOf(scene.nodes) as number[];
  const nodes = objectsOf(json, "nodes");
  const children = new Set(nodes.flatMap((node) => arrayOf(node.children)));
  return nodes.flatMap((_, i) => (children.has(i) ? [] : [i]));
}
