/** The role of each file of a drop: by its name, and where the name says nothing, by how the file begins. */
import { type Part, partOf } from "sim3align/case-names";
import { extensionsOf, meshResources } from "sim3align/input/formats";
import { baseName, extension } from "../input/files.js";
import { isBlackAndWhite } from "../input/label-masks.js";
import { photoExtensions } from "../input/photo.js";
import type { NamedFile, Role, Typed } from "../state/inputs.js";

/** Files that hold nothing but depth. */
const depthExtensions = extensionsOf("depth").filter((ending) => !extensionsOf("mask").includes(ending));

/** Depth files that other programs also use for photos, which no browser shows. */
const renderExtensions = ["exr", "tif", "tiff"];

/** Files that are meant as an input, but are read as none in most cases. */
const foreignExtensions = [...depthExtensions, "bmp", "gif", "fbx", "dae", "usd", "usdz", "blend", "3ds", "spz"];

/** Whether a file that is not used was probably meant to be. */
export const isForeign = ({ file, role }: Typed): boolean =>
  role === "unused" && foreignExtensions.includes(extension(file.path));

/** Whether a name contains one of the words, between characters that are no letters. */
const says = (name: string, words: string) => new RegExp(`(^|[^a-z])(${words})(s?)([^a-z]|$)`).test(name);

const depthWords = "d|depth|depthmap|disparity|zbuffer";
const maskWords = "mask|masks|matte|silhouette|visib|alpha";
const labelWords = "label|labels|seg|segmentation|instance|semantic|panoptic|ids";
const photoWords = "rgb|photo|image|img|color|colour|frame|left|right";
const cameraWords = /cam|intrin|calib/;
const textureWords = "texture|albedo|basecolor|diffuse|normal|roughness|metallic|material";

/** Whether a file has a usual name of a photo. */
export const isNamedPhoto = ({ path }: Pick<NamedFile, "path">): boolean => partOf(baseName(path)) === "image";

/** The roles of files. */
export function rolesOf(files: readonly NamedFile[]): Promise<Typed[]> {
  // BOP has masks of the whole object beside those of its visible part.
  const hasVisible = files.some(({ path }) => /(^|\/)mask_visib\//.test(path));
  return Promise.all(
    files.map(async (file) => {
      const isWhole = hasVisible && /(^|\/)mask\//.test(file.path);
      return { file, role: isWhole ? ("unused" as const) : await roleOf(file) };
    }),
  );
}

/** The roles of the usual names; of JSON, the content says more. */
const roleOfPart: Partial<Record<Part, Role>> = { depth: "depth", mask: "mask", camera: "camera", image: "photo" };

async function roleOf(file: NamedFile): Promise<Role> {
  const ending = extension(file.path);
  if (extensionsOf("mesh").includes(ending)) return "mesh";
  if (meshResources.includes(ending)) return "resource";
  const name = baseName(file.path).toLowerCase();
  if (ending === "json" || ending === "yaml" || ending === "yml") return roleOfJson(file, await headOf(file, 1 << 22));
  const part = partOf(name);
  const usual = part && roleOfPart[part];
  if (usual !== undefined) return usual;
  if (ending === "txt") return cameraWords.test(name) ? "camera" : "unused";
  const byName = pixelRole(name) ?? pixelRole(folderOf(file.path));
  if (photoExtensions.includes(ending)) return byName === "unused" ? byName : photoOrMask(file, byName);
  if (depthExtensions.includes(ending)) {
    const isOther = byName === "photo" && renderExtensions.includes(ending);
    return isOther || byName === "unused" || byName === "mask" || byName === "labels" ? "unused" : "depth";
  }
  if (ending !== "png" && ending !== "npy") return "unused";
  const role = byName ?? pixelRoleOf(ending, await headOf(file, 1 << 10));
  return role === "photo" && ending === "png" ? photoOrMask(file, byName) : role;
}

/** A picture of black and white is a mask, unless its name says that it is a photo. */
const photoOrMask = async (file: NamedFile, byName: Role | null): Promise<Role> =>
  byName !== "photo" && (await isBlackAndWhite(file)) ? "mask" : "photo";

const folderOf = (path: string) => (path.split("/").at(-2) ?? "").toLowerCase();

function pixelRole(name: string): Role | null {
  if (says(name, textureWords)) return "unused";
  if (says(name, depthWords)) return "depth";
  if (says(name, labelWords)) return "labels";
  if (says(name, maskWords)) return "mask";
  return says(name, photoWords) ? "photo" : null;
}

/** The role of an image without a telling name. */
function pixelRoleOf(ending: string, head: Uint8Array): Role {
  if (ending === "npy") {
    const descr = /'descr':\s*'[<>|=]?([a-z])(\d)/.exec(new TextDecoder("latin1").decode(head));
    return descr?.[1] === "f" || (descr?.[1] === "u" && descr[2] === "2") ? "depth" : "mask";
  }
  const [bits, colour] = [head[24] ?? 8, head[25] ?? 2];
  if (colour === 0 && bits === 16) return "depth";
  return colour === 2 || colour === 6 ? "photo" : "mask";
}

/** The role of a JSON or YAML file, by its keys. */
function roleOfJson(file: NamedFile, bytes: Uint8Array): Role {
  const text = new TextDecoder().decode(bytes);
  const has = (key: string) => text.includes(`"${key}"`) || new RegExp(`^\\s*${key}:`, "m").test(text);
  if (has("annotations") && has("images")) return "annotations";
  if (has("cam_R_m2c")) return "truth";
  if (has("counts") && has("size")) return "mask";
  const name = baseName(file.path).toLowerCase();
  if (has("camera_to_world")) return "pose";
  if (/^(meta|results?|scene_gt_info|package|pose|plane)\b/.test(name)) return "unused";
  if (/^(gt|truth)\b/.test(name)) return "truth";
  if (partOf(name) === "initial") return "initial";
  if (["fx", "K", "k", "cam_K", "intrinsic_matrix", "fovYDeg", "fov_y_deg", "camera_matrix"].some(has)) return "camera";
  if (has("rotation") || has("matrix")) return "truth";
  return partOf(name) === "camera" || cameraWords.test(name) ? "camera" : "unused";
}

async function headOf(file: NamedFile, length: number): Promise<Uint8Array> {
  return file.head === undefined ? (await file.bytes()).subarray(0, length) : file.head(length);
}
