/**
 * The formats of files and the kinds of depth that are read, each once. Errors, the help, the page and the names of case
 * files take them from here; `npm run update` writes them into the guides and the documentation of types. Readers load this
 * file: what only documents and user interfaces say is in `depth-kinds.ts`.
 */
import type { DepthCode, DepthKind, MeshFormat } from "../types/inputs.js";

/** Formats by name, each with its extensions. */
type FormatList = Readonly<Record<string, readonly string[]>>;

/** The formats of each kind of file. */
export const fileFormats = {
  depth: { NPY: ["npy"], "16-bit PNG": ["png"], NPZ: ["npz"], EXR: ["exr"], TIFF: ["tiff", "tif"], PFM: ["pfm"] },
  mask: { PNG: ["png"], NPY: ["npy"], JSON: ["json"], JPEG: ["jpg", "jpeg"] },
  mesh: {
    ...{ GLB: ["glb"], glTF: ["gltf"], OBJ: ["obj"], PLY: ["ply"], STL: ["stl"], SPLAT: ["splat"] },
  } satisfies Record<string, MeshFormat[]>,
  photo: { PNG: ["png"], JPEG: ["jpg", "jpeg"], WebP: ["webp"] },
  camera: {
    ...{ JSON: ["json"], text: ["txt", "csv", "pincam"], YAML: ["yaml", "yml"], XML: ["xml"], INI: ["conf", "ini"] },
    NPY: ["npy"],
  },
} as const satisfies Record<string, FormatList>;

/** A kind of file. */
export type FileKind = keyof typeof fileFormats;

/** Files that meshes of some formats refer to; textures apart. */
export const meshResources: readonly string[] = ["bin", "mtl"];

/** Whether a file may refer to other files, in its folder or below. */
export const refersToFiles = (path: string): boolean => /\.(glb|gltf|obj|mtl|ply)$/i.test(path);

/** The extensions of a kind of file, in lower case, without dots. */
export const extensionsOf = (kind: FileKind): readonly string[] =>
  Object.values<readonly string[]>(fileFormats[kind]).flat();

/** `A, B or C`. */
export const either = (words: readonly string[]): string =>
  [words.slice(0, -1).join(", "), words.at(-1)].filter(Boolean).join(" or ");

/** The formats of a kind of file: `PNG, JPEG or WebP`. */
export const formatsText = (kind: FileKind): string => either(Object.keys(fileFormats[kind]));

/** The kinds of depth, the default first. */
export const depthKindNames: readonly DepthKind[] = [
  "metric",
  "ray-distance",
  "scale-invariant",
  "affine-invariant",
  "affine-invariant-disparity",
];

/** The codes of depth. */
export const depthCodeNames: readonly DepthCode[] = [
  ...(["sun-rgbd", "lerobot", "behavior", "half-float", "rlbench", "carla", "rgba-float", "z-buffer"] as const),
];

/** Whether zero and negative values are readings, and 8-bit files are accepted. */
export const isAffineInvariant = (kind: DepthKind | undefined): boolean => kind?.startsWith("affine-") === true;
