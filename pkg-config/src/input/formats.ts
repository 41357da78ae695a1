/**
 * The formats of files and the kinds of depth that are read, each once. Errors, the help, the page and the names of case
 * files take them from here; `npm run update` writes them into the guides and the documentation of types.
 */
import type { DepthKind, MeshFormat } from "./types.js";

/** Formats by name, each with its extensions. */
type FormatList = Readonly<Record<string, readonly string[]>>;

/** The formats of each kind of file. */
export const fileFormats = {
  depth: { NPY: ["npy"], "16-bit PNG": ["png"], NPZ: ["npz"], EXR: ["exr"], TIFF: ["tiff", "tif"], PFM: ["pfm"] },
  mask: { PNG: ["png"], NPY: ["npy"], "COCO RLE": ["json"], JPEG: ["jpg", "jpeg"] },
  mesh: {
    ...{ GLB: ["glb"], glTF: ["gltf"], OBJ: ["obj"], PLY: ["ply"], STL: ["stl"], SPLAT: ["splat"] },
  } satisfies Record<string, MeshFormat[]>,
  photo: { PNG: ["png"], JPEG: ["jpg", "jpeg"], WebP: ["webp"] },
  camera: { JSON: ["json"], text: ["txt"], YAML: ["yaml", "yml"] },
} as const satisfies Record<string, FormatList>;

/** A kind of file. */
export type FileKind = keyof typeof fileFormats;

/** Files that meshes of some formats refer to; textures apart. */
export const meshResources: readonly string[] = ["bin", "mtl"];

/** Whether a file may refer to others, which are in its folder or below it. */
export const refersToFiles = (path: string): boolean => /\.(gltf|obj|mtl)$/i.test(path);

/** The extensions of a kind of file, in small letters, without dots. */
export const extensionsOf = (kind: FileKind): readonly string[] =>
  Object.values<readonly string[]>(fileFormats[kind]).flat();

/** `A, B or C`. */
export const either = (words: readonly string[]): string =>
  [words.slice(0, -1).join(", "), words.at(-1)].filter(Boolean).join(" or ");

/** The formats of a kind of file: `PNG, JPEG or WebP`. */
export const formatsText = (kind: FileKind): string => either(Object.keys(fileFormats[kind]));

/** A kind of depth. */
interface KindOfDepth {
  /** For people. */
  title: string;
  /** What the values are. */
  values: string;
  /** What is estimated with the pose. */
  estimated: string;
}

const unitKnown = "in a known unit";
const unitUnknown = "times an unknown factor";
const shifted = `${unitUnknown}, plus an unknown shift`;

/** The kinds of depth, the default first. The readers and the aligner know all but `ray-distance`, which needs the camera. */
export const depthKinds: { readonly [K in DepthKind]: KindOfDepth } = {
  metric: { title: "Distances", values: `distances along the optical axis ${unitKnown}`, estimated: "nothing" },
  "ray-distance": {
    title: "Distances along the rays",
    values: `distances from the camera's centre, along the ray of each pixel, ${unitKnown}`,
    estimated: "nothing",
  },
  "scale-invariant": {
    title: "Distances, scale unknown",
    values: `distances along the optical axis ${unitUnknown}`,
    estimated: "the scale, if a length is known",
  },
  "affine-invariant": {
    title: "Relative depth, far is large",
    values: `distances along the optical axis ${shifted}`,
    estimated: "shift, and the scale if a length is known",
  },
  "affine-invariant-disparity": {
    title: "Disparity, near is large",
    values: `inverse distances ${shifted}; near is large`,
    estimated: "shift, and the scale if a length is known",
  },
};

/** The names of the kinds. */
export const depthKindNames = Object.keys(depthKinds) as DepthKind[];

/** Whether values of this kind have no zero: those that are zero or negative are values, and 8 bits may hold them. */
export const isAffineInvariant = (kind: DepthKind | undefined): boolean => kind?.startsWith("affine-") === true;

/** The unit of metric depth about which nothing else is known. */
export const defaultUnits = "floats are metres, integers (16-bit PNG) millimetres";
