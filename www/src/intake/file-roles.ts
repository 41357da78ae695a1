/** The roles of the files of a drop: those of case folders by their names, then what words and extensions say. */
import type { DepthKind } from "sim3align";
import { isNoInput, partOf } from "sim3align/case-names";
import { requiredBytes } from "sim3align/input/bytes";
import { extensionsOf, type FileKind, meshResources } from "sim3align/input/formats";
import { isPointMap, sam3dScene } from "sim3align/scene/sam3d-files";
import { baseName, extension, folderOf } from "../input/files.js";
import { photoExtensions } from "../input/photo.js";
import type { NamedFile, Role, Typed } from "../state/inputs.js";

/** Words in names, and the kind of file that has them. */
const words: readonly (readonly [Role, FileKind, RegExp])[] = [
  ["depth", "depth", /(^|[^a-z])(depth|disparity)/],
  ["mask", "mask", /(^|[^a-z])mask/],
  ["photo", "photo", /(^|[^a-z])(rgb|photo|picture|image|img|colou?r)/],
  ["camera", "camera", /(^|[^a-z])(cam|intrinsic|calib)/],
  ["truth", "camera", /^(gt|truth)[^a-z].*json$/],
];

/** Files that hold nothing but depth. */
const depthExtensions = extensionsOf("depth").filter((ending) => !extensionsOf("mask").includes(ending));

/** Texts that programs write beside their results. */
const textExtensions = ["json", "txt", "md", "csv", "log", "html", "yaml", "yml", "py"];

/** The roles of files. A file whose name says nothing is not used until a person says what it is. */
export function rolesOf(files: readonly NamedFile[]): Typed[] {
  const hasTextures = files.some(({ path }) => ["gltf", "mtl"].includes(extension(path)));
  return files.map((file) => ({ file, role: roleOf(file.path, hasTextures) }));
}

function roleOf(path: string, hasTextures: boolean): Role {
  const [name, ending] = [baseName(path).toLowerCase(), extension(path)];
  if (isNoInput(path)) return "unused";
  const part = partOf(name);
  if (part !== undefined) return part === "image" ? "photo" : part;
  if (extensionsOf("mesh").includes(ending)) return "mesh";
  if (meshResources.includes(ending)) return "resource";
  for (const text of [name, folderOf(path).split("/").at(-2)?.toLowerCase() ?? ""]) {
    const found = words.find(([, kind, word]) => extensionsOf(kind).includes(ending) && word.test(text));
    if (found !== undefined) return found[0];
  }
  if (depthExtensions.includes(ending)) return "depth";
  const isPicture = photoExtensions.includes(ending);
  if (hasTextures && (isPicture || ending === "png")) return "resource";
  return isPicture ? "photo" : "unused";
}

/** Whether a person has to say what a file is. */
export const isUnassigned = ({ file: { path }, role }: Typed): boolean =>
  role === "unused" && !isNoInput(path) && !textExtensions.includes(extension(path));

/** Whether a file has the usual name of a photo. */
export const isNamedPhoto = ({ path }: Pick<NamedFile, "path">): boolean => partOf(baseName(path)) === "image";

/** The files of a scene folder, and what its depth is. */
interface ConvertedScene {
  files: readonly NamedFile[];
  /** Files that it was not made of. */
  left: readonly NamedFile[];
  depthKind: DepthKind;
}

/**
 * A scene folder of the files, if they are an output of SAM 3D Objects; `null` for others.
 * @throws what is missing or damaged in an output
 */
export async function fromSam3d(files: readonly NamedFile[]): Promise<ConvertedScene | null> {
  // Point maps of NPZ files are read as depth.
  const hasPoints = files.some(({ path }) => isPointMap(path) && extension(path) === "npy");
  if (!hasPoints && !(await Promise.all(files.map(isLayout))).includes(true)) return null;
  const contents = Object.fromEntries(files.map(({ path, bytes }) => [path, bytes]));
  const { files: made, depthKind, sources } = await sam3dScene(contents, "the files");
  const folder = (files[0]?.path ?? "").split("/").slice(0, -1)[0] ?? "SAM 3D";
  const named = Object.entries(made).map(([path, file]) => ({
    path: `${folder}/${path}`,
    bytes: async () => requiredBytes(path, typeof file === "function" ? await file() : file),
  }));
  const used = new Set(Object.values(sources));
  return { files: named, left: files.filter(({ path }) => !used.has(path)), depthKind };
}

/** Whether a file has a pose as its tensors are written: the size is a list. */
async function isLayout(file: NamedFile): Promise<boolean> {
  if (extension(file.path) !== "json" || /^(gt|truth)\b/.test(baseName(file.path))) return false;
  const text = new TextDecoder().decode(await file.bytes());
  return ["rotation", "translation"].every((key) => text.includes(`"${key}"`)) && /"scale"\s*:\s*\[/.test(text);
}
