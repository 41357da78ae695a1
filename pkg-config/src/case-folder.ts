/** Cases on disk (Node only). */
import { readdir, realpath, stat } from "node:fs/promises";
import { basename, dirname, join, resolve, sep } from "node:path";
import {
  type Case,
  type CaseFiles,
  caseFrom,
  type FoundFiles,
  fileNotFound,
  LEVELS,
  meshFile,
  type ReadCaseOptions,
  type ReadOnDisk,
} from "./case-files.js";
import { partOf } from "./case-names.js";
import { refersToFiles } from "./input/formats.js";
import { read, unreadable } from "./read-files.js";
import type { AlignInput, CameraInput, MeshFile } from "./types/inputs.js";
import { withoutUndefined } from "./values/validation.js";

export type { FoundFiles, ReadCaseOptions } from "./case-files.js";

/** A case on disk. */
export interface CaseOnDisk extends Pick<Case, "input" | "truth"> {
  name: string;
  found: FoundFiles;
}

/** The files of a case, given individually. */
export interface CasePaths {
  depth: string;
  mask: string;
  mesh: string;
  /** A camera file, or the camera. */
  camera?: string | { value: CameraInput } | undefined;
  image?: string | undefined;
}

/**
 * Reads a case folder.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readCaseFolder(folder: string, settings: ReadCaseOptions = {}): Promise<CaseOnDisk> {
  const files = await filesOfCase(folder);
  const { input, truth, ...found } = await caseFrom(files, settings, folder);
  return { name: basename(resolve(folder)), input, truth, found: { folder, ...found } };
}

/** A file in a folder, read on demand. */
export const fileIn =
  (argument: string, folder: string, path: string): ReadOnDisk =>
  async (isReferred) => {
    if (isReferred) await checkLink(folder, path);
    return read(argument, join(folder, path));
  };

/** Files of a folder, read on demand. */
export const filesIn = (argument: string, folder: string, paths: readonly string[]): CaseFiles =>
  Object.fromEntries(paths.map((path) => [path, fileIn(argument, folder, path)]));

/** Reads a mesh file, and the files next to it that it refers to. */
export async function readMeshFile(path: string): Promise<MeshFile> {
  const beside = async (uri: string) => {
    await checkLink(dirname(path), uri, [basename(path)]);
    return read("mesh", join(dirname(path), uri));
  };
  return meshFile(path, await read("mesh", path), beside);
}

/**
 * Refuses a link out of the folder of a mesh where the mesh refers to it: the mesh may be malicious. Where the mesh itself is such
 * a link, as in stores of large files, others may be as well.
 * @param meshes the names of the mesh; by default, of all meshes in the folder
 */
async function checkLink(folder: string, path: string, meshes?: readonly string[]): Promise<void> {
  const root = await realpath(folder).catch(() => resolve(folder));
  const isBelow = async (name: string) => {
    const target = await realpath(join(folder, name)).catch(() => undefined);
    return target === undefined || target.startsWith(root.endsWith(sep) ? root : root + sep);
  };
  if (await isBelow(path)) return;

  const names = meshes ?? (await readdir(folder)).filter((name) => partOf(name) === "mesh");
  for (const name of names) if (!(await isBelow(name))) return;
  const found = `a link at ${join(folder, path)} that leads out of its folder`;
  throw fileNotFound("mesh", found, "the files that the mesh refers to");
}

/** The files of a case folder; those in subfolders only if the mesh may refer to them. */
export async function filesOfCase(folder: string): Promise<CaseFiles> {
  const names = await namesInFolder("case", folder, "a folder with depth, mask and mesh");
  const refers = names.some((name) => partOf(name) === "mesh" && refersToFiles(name));
  return filesIn("case", folder, await filesBelow(folder, "", refers ? LEVELS : 1));
}

/** The paths of the files in a folder below `root`, down to so many levels; links are followed. */
export async function filesBelow(root: string, folder: string, levels: number): Promise<string[]> {
  const paths: string[] = [];
  for (const name of await readdir(join(root, folder)).catch(() => [])) {
    const path = `${folder}${name}`;
    const entry = await stat(join(root, path)).catch(() => undefined);
    if (!entry?.isDirectory()) paths.push(path);
    else if (levels > 1) paths.push(...(await filesBelow(root, `${path}/`, levels - 1)));
  }
  return paths;
}

/**
 * The names in a folder.
 * @param argument the name of the folder in errors
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` if it cannot be read
 */
export async function namesInFolder(argument: string, folder: string, expected: string): Promise<string[]> {
  return readdir(folder).catch((cause) => {
    throw unreadable(argument, folder, expected, cause);
  });
}

/** Reads a case from individual files. */
export async function readCaseFiles(
  name: string,
  paths: CasePaths,
  settings: ReadCaseOptions = {},
): Promise<CaseOnDisk> {
  const { camera, image: imagePath, ...files } = paths;
  const { image: withImage = true, ...more } = settings;
  const cameraPath = typeof camera === "string" ? camera : undefined;
  const [depth, mask, mesh, cameraFile, image] = await Promise.all([
    read("depth", paths.depth),
    read("mask", paths.mask),
    readMeshFile(paths.mesh),
    cameraPath === undefined ? undefined : read("camera", cameraPath),
    imagePath === undefined || !withImage ? undefined : read("image", imagePath),
  ]);
  const stated = typeof camera === "object" ? camera.value : undefined;
  const input: object = withoutUndefined({ depth, mask, mesh, camera: stated, cameraFile, image, ...more });
  const named = withoutUndefined({ ...files, camera: cameraPath, image: withImage ? imagePath : undefined });
  const found = { folder: "", files: named as FoundFiles["files"], unread: [] };
  return { name, input: input as AlignInput, found, truth: null };
}
