/** The inputs of a scene: which file is what, and which mask belongs to which mesh. Nothing is read yet. */
import type { DepthKind } from "sim3align";

/** A file and its path in the folder or archive that it came from. */
export interface NamedFile {
  path: string;
  bytes(): Promise<Uint8Array>;
  /** In bytes, where it is known without reading them. */
  size?: number;
}

/** What a file is used for; `resource` is a file that a mesh refers to. */
export type Role =
  | "depth"
  | "photo"
  | "camera"
  | "mask"
  | "mesh"
  | "truth"
  | "initial"
  | "pose"
  | "resource"
  | "unused";

/** A file with its role. */
export interface Typed {
  file: NamedFile;
  role: Role;
}

/** The camera: a file, intrinsics (`null` is still to be entered), or an assumed field of view. */
export type CameraSource =
  | {
      kind: "file";
      file: NamedFile;
    }
  | { kind: "numbers"; fx: number | null; fy: number | null; cx: number | null; cy: number | null }
  | { kind: "assumed"; fovYDeg: number };

/** A mesh file and the files that it may refer to. */
export interface MeshSource {
  file: NamedFile;
  siblings: readonly NamedFile[];
}

/** A mask: what a file marks, or what it leaves out. */
export interface MaskSource {
  file: NamedFile;
  /** Whether a person has drawn it here: no other file has it. */
  isDrawn?: boolean;
  /** Whether the file marks the background. */
  isInverted?: boolean;
}

/** An object: its mask and its mesh, of which one may still be missing. */
export interface ObjectFiles {
  name: string;
  mask: MaskSource | null;
  mesh: MeshSource | null;
  /** The true pose. */
  truth: NamedFile | null;
  /** A pose that is a candidate of its search. */
  initial?: NamedFile | undefined;
}

/** The inputs. */
export interface Inputs {
  /** By which the scene is listed and kept; empty for samples, which are neither. */
  id: string;
  name: string;
  /** The id of the sample, or null for the user's own files. */
  sample: string | null;
  depth: NamedFile | null;
  /** Metres per unit of depth; null is the default of the reader. */
  depthScale: number | null;
  /** What the values of the depth map are; null is what the file suggests. */
  depthKind: DepthKind | null;
  photo: NamedFile | null;
  /** Without one, it is that of the depth file, that of the photo's EXIF data, or estimated together with the poses. */
  camera: CameraSource | null;
  /** The image in files that describe several. */
  imageId: string | null;
  objects: readonly ObjectFiles[];
  /** All meshes that can be chosen for an object. */
  meshes: readonly MeshSource[];
  /** Whether masks of another size are resized to the depth map. */
  resizeMasks: boolean;
  /** All files with their roles, also those that are not used. */
  files: readonly Typed[];
  /** The frames of a video; the other inputs are those of the first one. */
  frames?: readonly Inputs[];
}

export const noInputs: Inputs = {
  id: "",
  name: "",
  sample: null,
  depth: null,
  depthScale: null,
  depthKind: null,
  photo: null,
  camera: null,
  imageId: null,
  objects: [],
  meshes: [],
  resizeMasks: false,
  files: [],
};

/** An id that no other scene has. */
export const newId = (): string => `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;

/** The inputs of the user's own scene, with an id. */
export const withId = (inputs: Inputs): Inputs => (inputs.id !== "" ? inputs : { ...inputs, id: newId() });

/** The inputs with another mask for an object. */
export const withMask =
  (index: number, change: (mask: MaskSource) => MaskSource) =>
  (inputs: Inputs): Inputs => ({
    ...inputs,
    objects: inputs.objects.map((one, i) =>
      i === index && one.mask !== null ? { ...one, mask: change(one.mask) } : one,
    ),
  });

/** The inputs with the mask of an object inverted. */
export const withInverted = (index: number) =>
  withMask(index, (mask) => ({ ...mask, isInverted: mask.isInverted !== true }));

/** The input fields. */
export type Field = "files" | "depth" | "photo" | "camera" | "mask" | "mesh";

/** Makes the value of a key at its first use, and keeps it for as long as the key exists. */
export function once<K extends object, V>(make: (key: K) => V): (key: K) => V {
  const made = new WeakMap<K, V>();
  return (key) => {
    const value = made.get(key) ?? make(key);
    made.set(key, value);
    return value;
  };
}
