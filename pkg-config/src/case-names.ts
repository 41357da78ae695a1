/** The names of the files of a case: one table, for folders and frames, scenes, the page and the help. Case does not matter. */
import type { MeshFormat } from "./input/types.js";
import { failure } from "./values/error.js";

const table = {
  depth: { stems: ["depth"], extensions: ["npy", "png", "npz", "exr", "tiff", "tif", "pfm"] },
  mask: { stems: ["mask"], extensions: ["png", "npy", "json", "jpg", "jpeg", "webp"] },
  mesh: {
    stems: ["mesh"],
    extensions: ["glb", "gltf", "obj", "ply", "stl", "splat"] satisfies MeshFormat[],
  },
  camera: {
    stems: [
      ...["camera", "cameras", "scene_camera", "camera_info", "camera_intrinsics", "cam_K", "K"],
      ...["intrinsics", "intrinsic", "intrinsics_depth", "intrinsic_depth", "intrinsics_color", "intrinsic_color"],
    ],
    extensions: ["json", "txt", "yaml", "yml"],
  },
  image: { stems: ["rgb", "image", "photo", "color", "colour"], extensions: ["png", "jpg", "jpeg", "webp"] },
  /** The true pose. */
  truth: { stems: ["gt"], extensions: ["json"] },
  /** A first pose of an object of a scene: one candidate among those of the search. */
  initial: { stems: ["initial"], extensions: ["json"] },
  /** The pose of the camera of a frame. */
  pose: { stems: ["pose"], extensions: ["json"] },
} as const satisfies Record<string, { stems: readonly string[]; extensions: readonly string[] }>;

/** A part of a case that is a file. */
export type Part = keyof typeof table;

const parts = Object.keys(table) as Part[];
const rowOf = (part: Part): { stems: readonly string[]; extensions: readonly string[] } => table[part];

/** The names that the file of a part may have. */
export function namesOf(part: Part): string[] {
  const { stems, extensions } = rowOf(part);
  return stems.flatMap((stem) => extensions.map((extension) => `${stem}.${extension}`));
}

/** The names of a part for people: `depth.npy, .png or .npz`; `rgb or image (.png or .jpg)`. */
export function namesText(part: Part): string {
  const { stems, extensions } = rowOf(part);
  const endings = either(extensions.map((extension) => `.${extension}`));
  return stems.length === 1 ? `${stems[0]}${endings}` : `${either(stems)} (${endings})`;
}

const either = (words: readonly string[]) => [words.slice(0, -1).join(", "), words.at(-1)].filter(Boolean).join(" or ");

/** The part that a file is by its name; `undefined` for another file, and for one in a folder below. */
export function partOf(path: string): Part | undefined {
  const [, stem, ending = ""] = /^(?:\.\.\/)?(.*)\.([^.]+)$/s.exec(path.toLowerCase()) ?? [];
  return parts.find((part) => {
    const { stems, extensions } = rowOf(part);
    return extensions.includes(ending) && stems.some((known) => known.toLowerCase() === stem);
  });
}

/** Files of operating systems and of results of this package, which belong to no case. */
export const isNoInput = (path: string): boolean =>
  /(^|\/)(\..*|__MACOSX\/.*|Thumbs\.db|desktop\.ini|results?\.(jsonl?|csv)(\.lock)?)$/i.test(path);

/**
 * The name of the file of a part; `undefined` without one. Beside the intrinsics of the depth camera, those of the colour
 * camera are passed over.
 * @param owner whose part it is, in errors; by default, the part itself
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` if several files have names of the part: none is better than another
 */
export function fileOf(part: Part, names: readonly string[], place: string, owner: string = part): string | undefined {
  const known = namesOf(part).map((name) => name.toLowerCase());
  const order = (name: string) => known.indexOf(name.toLowerCase());
  const all = names.filter((name) => partOf(name) === part).sort((a, b) => order(a) - order(b));
  const ofDepth = all.filter((name) => /depth/i.test(name));
  const found = ofDepth.length === 0 ? all : all.filter((name) => !/color/i.test(name));
  if (found.length < 2) return found[0];
  const remedy =
    "Remove or rename the others; on the command line, --depth, --mask, --mesh, --camera and --image name files one by one.";
  throw failure("INVALID_ARGUMENT", owner, `${found.join(" and ")} in ${place}`, "one of them", remedy);
}
