/** Joins the glTF documents of several files into one. Nothing is decoded: indices are moved. */
import { isRecord } from "../values/values.js";

type Json = Record<string, unknown>;

/** A GLB file: its JSON, and its binary chunk. */
export interface GltfParts {
  json: Json;
  binary: Uint8Array;
}

/** The lists of a document that others refer to by index. */
const lists = [
  ...["accessors", "bufferViews", "images", "samplers", "textures", "materials", "meshes", "nodes", "skins"],
  ...["animations", "cameras"],
] as const;

type List = (typeof lists)[number];

/** The lists that the properties of each kind of object refer to, with one index or several. */
const references: Readonly<Record<string, Readonly<Record<string, List>>>> = {
  accessors: { bufferView: "bufferViews" },
  images: { bufferView: "bufferViews" },
  textures: { source: "images", sampler: "samplers" },
  meshes: { indices: "accessors", material: "materials", bufferView: "bufferViews" },
  nodes: { mesh: "meshes", skin: "skins", camera: "cameras", node: "nodes", children: "nodes" },
  skins: { inverseBindMatrices: "accessors", skeleton: "nodes", joints: "nodes" },
  animations: { input: "accessors", output: "accessors", node: "nodes" },
  bufferViews: {},
  materials: {},
  samplers: {},
  cameras: {},
};

/** A growing document. */
export class MergedGltf {
  readonly #lists = Object.fromEntries(lists.map((list) => [list, [] as unknown[]])) as Record<List, unknown[]>;
  readonly #binaries: Uint8Array[] = [];
  readonly #extensions: Record<"extensionsUsed" | "extensionsRequired", Set<string>> = {
    extensionsUsed: new Set(),
    extensionsRequired: new Set(),
  };
  readonly #lights: unknown[] = [];
  #length = 0;

  /** Adds the content of a file; returns the indices of the nodes that its scene shows. */
  add({ json, binary }: GltfParts): number[] {
    const starts = Object.fromEntries(lists.map((list) => [list, this.#lists[list].length])) as Record<List, number>;
    const byteStart = this.addBinary(binary);
    const lightStart = this.#lights.length;
    for (const list of lists) {
      for (const item of arrayOf(json[list])) {
        this.#lists[list].push(this.#moved(list, item, starts, byteStart, lightStart));
      }
    }
    this.#lights.push(...arrayOf(lightsOf(json)));
    for (const name of ["extensionsUsed", "extensionsRequired"] as const) {
      for (const extension of arrayOf(json[name])) this.#extensions[name].add(String(extension));
    }
    return shownNodes(json).map((node) => starts.nodes + node);
  }

  /** Adds an item to a list; returns its index. */
  push(list: List, item: object): number {
    return this.#lists[list].push(item) - 1;
  }

  /** Adds bytes to the buffer, at a multiple of four; returns where. */
  addBinary(bytes: Uint8Array): number {
    const start = this.#length;
    this.#binaries.push(bytes);
    this.#length = Math.ceil((start + bytes.length) / 4) * 4;
    return start;
  }

  /** The document that shows these nodes, and its buffer. */
  finish(nodes: readonly number[]): GltfParts {
    const binary = new Uint8Array(this.#length);
    let place = 0;
    for (const bytes of this.#binaries) {
      binary.set(bytes, place);
      place = Math.ceil((place + bytes.length) / 4) * 4;
    }
    const filled = Object.entries(this.#lists).filter(([, list]) => list.length > 0);
    const extensions = Object.entries(this.#extensions).filter(([, names]) => names.size > 0);
    const json = {
      asset: { version: "2.0", generator: "sim3align" },
      ...Object.fromEntries(extensions.map(([name, names]) => [name, [...names]])),
      ...(this.#lights.length > 0 ? { extensions: { KHR_lights_punctual: { lights: this.#lights } } } : {}),
      scene: 0,
      scenes: [{ nodes }],
      ...Object.fromEntries(filled),
      ...(binary.length > 0 ? { buffers: [{ byteLength: binary.length }] } : {}),
    };
    return { json, binary };
  }

  /** An item with its indices moved. */
  #moved(list: List, item: unknown, starts: Record<List, number>, byteStart: number, lightStart: number): unknown {
    const known = references[list] as Readonly<Record<string, List>>;
    const move = (value: unknown, key: string, parent: string): unknown => {
      if (typeof value === "number") {
        const target = targetOf(list, key, parent, known);
        if (target !== undefined) return starts[target] + value;
        if (list === "bufferViews" && key === "buffer") return 0;
        if (list === "bufferViews" && key === "byteOffset") return byteStart + value;
        if (list === "nodes" && key === "light" && parent === "KHR_lights_punctual") return lightStart + value;
        return value;
      }
      // Application data, which may contain anything.
      if (key === "extras") return value;
      if (Array.isArray(value)) return value.map((inner) => move(inner, key, parent));
      if (!isRecord(value)) return value;
      // Its attributes are ids of the compressed data.
      if (key === "KHR_draco_mesh_compression" && typeof value.bufferView === "number") {
        return { ...value, bufferView: starts.bufferViews + value.bufferView };
      }
      const entries = Object.entries(value).map(([name, inner]) => [name, move(inner, name, key)]);
      const copy = Object.fromEntries(entries) as Json;
      // A view without an offset begins where the buffer of its file did.
      if (list === "bufferViews" && "buffer" in copy && !("byteOffset" in copy)) copy.byteOffset = byteStart;
      return copy;
    };
    return move(item, "", "");
  }
}

/** The list that a number refers to, by its name and that of its parent. */
function targetOf(list: List, key: string, parent: string, known: Readonly<Record<string, List>>): List | undefined {
  // Attributes are named by their semantics, here and in morph targets.
  if (list === "meshes" && (parent === "attributes" || parent === "targets")) return "accessors";
  if (list === "materials" && key === "index" && parent.toLowerCase().endsWith("texture")) return "textures";
  return known[key];
}

const arrayOf = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);

function lightsOf(json: Json): unknown {
  const extensions = isRecord(json.extensions) ? json.extensions : {};
  const punctual = extensions.KHR_lights_punctual;
  return isRecord(punctual) ? punctual.lights : undefined;
}

/** The nodes that the scene of a document shows; without a scene, those without a parent. */
function shownNodes(json: Json): number[] {
  const scene = typeof json.scene === "number" ? json.scene : 0;
  const shown = arrayOf(json.scenes)[scene];
  if (isRecord(shown)) return arrayOf(shown.nodes) as number[];
  const nodes = arrayOf(json.nodes).map((node) => (isRecord(node) ? node : {}));
  const children = new Set(nodes.flatMap((node) => arrayOf(node.children)));
  return nodes.flatMap((_, i) => (children.has(i) ? [] : [i]));
}
