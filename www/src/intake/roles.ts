/** The role of each file of a drop: by its name, and where the name says nothing, by how the file begins. */
import { INITIAL_FILE } from "sim3align/case-files";
import { baseName, extension, type NamedFile } from "../load/files.js";
import type { Role, Typed } from "../load/inputs.js";

export const meshExtensions = ["glb", "gltf", "obj", "ply", "stl"];
const photoExtensions = ["jpg", "jpeg", "webp"];
export const resourceExtensions = ["bin", "mtl"];
/** Files of depth models. */
const depthExtensions = ["npz", "exr", "tif", "tiff", "pfm"];

/** Whether a name contains one of the words, between characters that are no letters. */
const says = (name: string, words: string) => new RegExp(`(^|[^a-z])(${words})(s?)([^a-z]|$)`).test(name);

const depthWords = "d|depth|depthmap|disparity|zbuffer";
const maskWords = "mask|masks|matte|silhouette|visib|alpha";
const labelWords = "label|labels|seg|segmentation|instance|semantic|panoptic|ids";
const photoWords = "rgb|photo|image|img|color|colour|frame|left|right";
const textureWords = "texture|albedo|basecolor|diffuse|normal|roughness|metallic|material";

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

async function roleOf(file: NamedFile): Promise<Role> {
  const ending = extension(file.path);
  if (meshExtensions.includes(ending)) return "mesh";
  if (resourceExtensions.includes(ending)) return "resource";
  if (ending === "json" || ending === "yaml" || ending === "yml") return roleOfJson(file, await headOf(file, 1 << 22));
  const name = baseName(file.path).toLowerCase();
  const byName = pixelRole(name) ?? pixelRole(folderOf(file.path));
  if (photoExtensions.includes(ending)) return byName === "unused" ? byName : "photo";
  if (depthExtensions.includes(ending)) return byName === "unused" || byName === "mask" ? "unused" : "depth";
  if (ending !== "png" && ending !== "npy") return "unused";
  return byName ?? pixelRoleOf(ending, await headOf(file, 1 << 10));
}

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
  if (name === INITIAL_FILE) return "initial";
  if (["fx", "K", "k", "cam_K", "intrinsic_matrix", "fovYDeg", "fov_y_deg", "camera_matrix"].some(has)) return "camera";
  if (has("rotation") || has("matrix")) return "truth";
  return /cam|intrin|calib/.test(name) ? "camera" : "unused";
}

async function headOf(file: NamedFile, length: number): Promise<Uint8Array> {
  return file.head === undefined ? (await file.bytes()).subarray(0, length) : file.head(length);
}
