/** The names of the files of a case: one table, for folders and frames, scenes, the page and the help. Case does not matter. */
import { either, extensionsOf } from "./input/formats.js";
import { failure } from "./values/error.js";

/** The names of the files of each part, and their extensions. */
export const caseNames = {
  depth: { stems: ["depth"], extensions: extensionsOf("depth") },
  // The reader refuses WebP with a reason.
  mask: { stems: ["mask"], extensions: [...extensionsOf("mask"), "webp"] },
  mesh: { stems: ["mesh"], extensions: extensionsOf("mesh") },
  camera: {
    stems: [
      ...["camera", "cameras", "scene_camera", "camera_info", "camera_intrinsics", "cam_K", "K"],
      ...["intrinsics", "intrinsic", "intrinsics_depth", "intrinsic_depth", "intrinsics_color", "intrinsic_color"],
    ],
    extensions: extensionsOf("camera"),
  },
  image: { stems: ["rgb", "image", "photo", "color", "colour"], extensions: extensionsOf("photo") },
  /** The true pose. */
  truth: { stems: ["gt"], extensions: ["json", "txt"] },
  /** A first pose of an object of a scene: one candidate among those of the search. */
  initial: { stems: ["initial"], extensions: ["json", "txt"] },
  /** The pose of the camera of a frame. */
  pose: { stems: ["pose"], extensions: ["json", "txt"] },
} satisfies Record<string, { stems: string[]; extensions: readonly string[] }>;

/** A part of a case that is a file. */
export type Part = keyof typeof caseNames;

const parts = Object.keys(caseNames) as Part[];

/** The names that the file of a part may have. */
export function namesOf(part: Part): string[] {
  const { stems, extensions } = caseNames[part];
  return stems.flatMap((stem) => extensions.map((extension) => `${stem}.${extension}`));
}

/** The names of a part for people: `depth.npy, .png or .npz`; `rgb or image (.png or .jpg)`. */
export function namesText(part: Part): string {
  const { stems, extensions } = caseNames[part];
  const endings = either(extensions.map((extension) => `.${extension}`));
  return stems.length === 1 ? `${stems[0]}${endings}` : `${either(stems)} (${endings})`;
}

/** The part that a file is by its name; `undefined` for another file, and for one in a folder below. */
export function partOf(path: string): Part | undefined {
  const [, stem, ending = ""] = /^(?:\.\.\/)?(.*)\.([^.]+)$/s.exec(path.toLowerCase()) ?? [];
  return parts.find((part) => {
    const { stems, extensions } = caseNames[part];
    return extensions.includes(ending) && stems.some((known) => known.toLowerCase() === stem);
  });
}

/** The files of intrinsics; beside those of the depth camera, which come first, without those of the colour camera. */
export function ofDepthCamera<T>(files: readonly T[], nameOf: (file: T) => string): readonly T[] {
  const ofDepth = files.filter((file) => /depth/i.test(nameOf(file)));
  const others = files.filter((file) => !/depth|color/i.test(nameOf(file)));
  return ofDepth.length === 0 ? files : [...ofDepth, ...others];
}

/** Files of operating systems and of results of this package, which belong to no case. */
export const isNoInput = (path: string): boolean =>
  /(^|\/)(\..*|__MACOSX\/.*|Thumbs\.db|desktop\.ini|results?\.(jsonl?|csv)(\.lock)?)$/i.test(path);

/**
 * The name of the file of a part; `undefined` without one.
 * @param owner whose part it is, in errors; by default, the part itself
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` if several files have names of the part: none is better than another
 */
export function fileOf(part: Part, names: readonly string[], place: string, owner: string = part): string | undefined {
  const known = namesOf(part).map((name) => name.toLowerCase());
  const order = (name: string) => known.indexOf(name.toLowerCase());
  const all = names.filter((name) => partOf(name) === part).sort((a, b) => order(a) - order(b));
  const found = part === "camera" ? ofDepthCamera(all, (name) => name) : all;
  if (found.length < 2) return found[0];
  const remedy =
    "Remove or rename the others; on the command line, --depth, --mask, --mesh, --camera and --image name files one by one.";
  throw failure("INVALID_ARGUMENT", owner, `${found.join(" and ")} in ${place}`, "one of them", remedy);
}
