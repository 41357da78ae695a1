/** Cases on disk (Node only). */
import { existsSync } from "node:fs";
import { readdir, readFile, stat } from "node:fs/promises";
import { basename, dirname, join, resolve } from "node:path";
import {
  type Case,
  type CaseFiles,
  caseFiles,
  caseFrom,
  type FrameFiles,
  fileNotFound,
  frameFrom,
  meshFile,
  onlyFile,
  type ReadCaseOptions,
} from "./case-files.js";
import type { AlignInput, CameraInput, MeshFile } from "./input/types.js";
import { formatsModule } from "./modules/readers.js";
import { failure, Sim3AlignError } from "./values/error.js";
import { withoutUndefined } from "./values/values.js";

export type { ReadCaseOptions } from "./case-files.js";

/** A case on disk. `files` contains paths. */
export interface CaseOnDisk extends Omit<Case, "files"> {
  name: string;
  files: Readonly<Record<string, string>>;
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

export const loadFormats = () => formatsModule.load();

/**
 * Reads a case folder.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readCaseFolder(folder: string, settings: ReadCaseOptions = {}): Promise<CaseOnDisk> {
  const found = await caseFrom(filesIn("case", folder, await pathsIn(folder)), settings, loadFormats, folder);
  return { ...found, name: basename(resolve(folder)), files: pathsOf(folder, found.files) };
}

/** Files of a folder, read on demand. */
export const filesIn = (argument: string, folder: string, paths: readonly string[]): CaseFiles =>
  Object.fromEntries(paths.map((path) => [path, () => read(argument, join(folder, path))]));

const pathsOf = (folder: string, files: Readonly<Record<string, string>>) =>
  Object.fromEntries(Object.entries(files).map(([part, name]) => [part, join(folder, name)]));

/** Several frames of one object, on disk. */
export interface FramesOnDisk {
  /** The mesh. */
  mesh: MeshFile;
  /** The frames, by their names, in order. */
  frames: ({ name: string } & FrameFiles)[];
}

/** The names of the `frame_*` folders of a case, in order; none for a case of one view. */
export async function frameNames(folder: string): Promise<string[]> {
  const entries = await readdir(folder, { withFileTypes: true }).catch(() => []);
  const names = entries.filter((entry) => entry.isDirectory() && entry.name.startsWith("frame_"));
  return names.map(({ name }) => name).sort();
}

/**
 * Reads a case folder with `frame_*` folders.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readFrames(folder: string, settings: ReadCaseOptions = {}): Promise<FramesOnDisk> {
  const names = await frameNames(folder);
  const frames = names.map(async (name) => ({ name, ...(await readFrame(join(folder, name), settings)) }));
  return { mesh: await readMeshFile(meshIn(folder)), frames: await Promise.all(frames) };
}

/** A frame as an input for `align` and `evaluate`; `undefined` without a mask. */
export function inputOfFrame({ input }: Pick<FrameFiles, "input">, mesh: MeshFile): AlignInput | undefined {
  const { cameraToWorld: _, ...view } = input;
  return view.mask === undefined ? undefined : ({ ...view, mesh } as AlignInput);
}

/** The path of the mesh of a case. */
export function meshIn(folder: string): string {
  const name = onlyFile("mesh", (name) => existsSync(join(folder, name)), folder);
  if (name === undefined) throw fileNotFound("mesh", `no such file in ${folder}`, caseFiles.mesh.join(" or "));
  return join(folder, name);
}

/** Reads a mesh file, and the files next to it that it refers to. */
export async function readMeshFile(path: string): Promise<MeshFile> {
  const beside = (uri: string) => read("mesh", join(dirname(path), uri));
  return meshFile(path, await read("mesh", path), loadFormats, beside);
}

/** Reads a frame of a case. `files` contains paths. */
export async function readFrame(folder: string, settings: ReadCaseOptions): Promise<FrameFiles> {
  const frame = await frameFrom(filesIn("frame", folder, await readdir(folder)), settings, folder);
  return { ...frame, files: pathsOf(folder, frame.files) };
}

/** Paths of the files in a case folder; includes subfolders only if the mesh may refer to them. */
async function pathsIn(folder: string): Promise<string[]> {
  const names = await namesIn("case", folder, "a folder with depth, mask and mesh");
  const mesh = caseFiles.mesh.find((name) => names.includes(name));
  if (mesh !== "mesh.gltf" && mesh !== "mesh.obj") return names;
  return (await readdir(folder, { recursive: true })).map((path) => path.replaceAll("\\", "/"));
}

/**
 * The names in a folder.
 * @param argument the name of the folder in errors
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` if it cannot be read
 */
export async function namesIn(argument: string, folder: string, expected: string): Promise<string[]> {
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
  return {
    name,
    input: input as AlignInput,
    files: withoutUndefined({ ...files, camera: cameraPath, image: imagePath }) as CaseOnDisk["files"],
    truth: null,
  };
}

/** The largest file that Node reads at once, bytes. */
const LARGEST = 2 ** 31 - 1;

/** The bytes of a file. Pipes and devices, which may have no end, are not read. */
export async function read(argument: string, path: string): Promise<Uint8Array> {
  try {
    const file = await stat(path);
    if (!file.isFile()) throw fileNotFound(argument, `no ordinary file at ${path}`, "a readable file");
    if (file.size > LARGEST) {
      const remedy = "Crop the image to the object, or simplify the mesh.";
      throw failure("FILE_TOO_LARGE", argument, `${file.size} bytes at ${path}`, `at most ${LARGEST}`, remedy);
    }
    return await readFile(path);
  } catch (cause) {
    throw cause instanceof Sim3AlignError ? cause : unreadable(argument, path, "a readable file", cause);
  }
}

function unreadable(argument: string, path: string, expected: string, cause: unknown) {
  const isMissing = cause instanceof Error && "code" in cause && cause.code === "ENOENT";
  const reason = cause instanceof Error && "code" in cause && !isMissing ? ` (${cause.code})` : "";
  return fileNotFound(argument, `nothing to read at ${path}${reason}`, expected, cause);
}
