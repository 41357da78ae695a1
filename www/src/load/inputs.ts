/** The input files of a scene, and which field each belongs to. */
import { baseName, extension, type NamedFile, stem } from "./files.js";

/** The camera: a file, intrinsics, or an assumed field of view. */
export type CameraSource =
  | { kind: "file"; file: NamedFile }
  | { kind: "numbers"; fx: number; fy: number; cx: number; cy: number }
  | { kind: "assumed"; fovYDeg: number };

/** A mesh file and the files that it may refer to. */
export interface MeshSource {
  file: NamedFile;
  siblings: readonly NamedFile[];
}

/** The inputs. Nothing is read yet. */
export interface Inputs {
  name: string;
  sample: string | null;
  depth: NamedFile | null;
  /** Metres per unit of depth; null is the default of the reader. */
  depthScale: number | null;
  photo: NamedFile | null;
  camera: CameraSource | null;
  masks: readonly NamedFile[];
  meshes: readonly MeshSource[];
  truths: readonly NamedFile[];
  /** Whether masks of another size are resized to the depth map. */
  resizeMasks: boolean;
}

export const noInputs: Inputs = {
  name: "",
  sample: null,
  depth: null,
  depthScale: null,
  photo: null,
  camera: null,
  masks: [],
  meshes: [],
  truths: [],
  resizeMasks: false,
};

/** The input fields. */
export type Field = "depth" | "mask" | "mesh" | "camera" | "photo";

const meshExtensions = ["glb", "gltf", "obj", "ply", "stl"];

/** The kind of a file, by its name; null if it is not an input. */
export function kindOf(path: string): Field | "truth" | null {
  const name = baseName(path).toLowerCase();
  const ending = extension(name);
  if (meshExtensions.includes(ending)) return "mesh";
  if (ending === "json") {
    if (/^(gt|truth|scene_gt)\b/.test(name)) return "truth";
    if (/mask|rle|coco/.test(name)) return "mask";
    return /^(meta|results?)\b/.test(name) ? null : "camera";
  }
  if (ending === "npy") return /mask|seg/.test(name) ? "mask" : "depth";
  if (ending === "jpg" || ending === "jpeg" || ending === "webp") return "photo";
  if (ending !== "png") return null;
  if (/mask|seg/.test(name)) return "mask";
  return /depth/.test(name) || /^d(epth)?\d*\./.test(name) ? "depth" : "photo";
}

/** Assigns files to inputs by their names. Inputs without a new file are kept. */
export function assignFiles(files: readonly NamedFile[], present: Inputs, name?: string): Inputs {
  const of = (kind: Field | "truth") => files.filter(({ path }) => kindOf(path) === kind);
  const [depth, camera, photo] = [of("depth")[0], of("camera")[0], of("photo")[0]];
  const [masks, meshes] = [of("mask"), of("mesh")];
  // A new depth map is a new scene.
  const base = depth === undefined ? present : noInputs;
  const sorted = (list: readonly NamedFile[]) => [...list].sort((a, b) => (a.path < b.path ? -1 : 1));
  return {
    ...base,
    name: name ?? (base.name || folderOf(files) || "Own files"),
    sample: null,
    depth: depth ?? base.depth,
    photo: photo ?? base.photo,
    camera: camera === undefined ? base.camera : { kind: "file", file: camera },
    masks: masks.length > 0 ? sorted(masks) : base.masks,
    meshes: meshes.length > 0 ? sorted(meshes).map((file) => ({ file, siblings: files })) : base.meshes,
    truths: meshes.length > 0 || masks.length > 0 ? sorted(of("truth")) : base.truths,
  };
}

function folderOf(files: readonly NamedFile[]): string {
  const parts = files[0]?.path.split("/") ?? [];
  return parts.length > 1 ? (parts.at(-2) ?? "") : "";
}

/** The file for a mask: the one with the same suffix (`mask-cup.png`, `mesh-cup.glb`), or the only one. */
export function matchingFile<T>(mask: NamedFile, others: readonly T[], pathOf: (other: T) => string): T | undefined {
  const key = (path: string) => `${path.slice(0, -baseName(path).length)}${stem(path).replace(/^[a-z]+/i, "")}`;
  return others.find((other) => key(pathOf(other)) === key(mask.path)) ?? (others.length === 1 ? others[0] : undefined);
}
