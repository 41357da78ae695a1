/** Outputs of SAM 3D Objects among the files of a drop. */
import type { DepthKind } from "sim3align";
import { requiredBytes } from "sim3align/input/bytes";
import { sam3dScene } from "sim3align/scene/sam3d-files";
import { baseName, extension } from "../input/files.js";
import type { NamedFile } from "../state/inputs.js";

/** The files of a scene folder, and what its depth is. */
interface MadeScene {
  files: readonly NamedFile[];
  /** Files that it was not made of. */
  left: readonly NamedFile[];
  depthKind: DepthKind;
}

/**
 * A scene folder of the files, if they are an output of SAM 3D Objects; `null` for others.
 * @throws what is missing or damaged in an output
 */
export async function fromSam3d(files: readonly NamedFile[]): Promise<MadeScene | null> {
  const layouts = await Promise.all(files.map(isLayout));
  if (!layouts.includes(true)) return null;
  const {
    files: made,
    depthKind,
    sources,
  } = await sam3dScene(Object.fromEntries(files.map(({ path, bytes }) => [path, bytes])), "the files");
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
