/** Folders with frames of one object on disk (Node only). */
import { readdir } from "node:fs/promises";
import { join, parse } from "node:path";
import { type CaseFiles, type FrameFiles, filesOf, frameFrom, meshFile, type ReadCaseOptions } from "./case-files.js";
import { type FoundFiles, filesBelow, filesIn, filesOfCase, LEVELS } from "./case-folder.js";
import { type Part, partOf } from "./case-names.js";
import type { AlignInput, MeshFile } from "./types/inputs.js";
import { naturally } from "./values/order.js";
import { withoutUndefined } from "./values/validation.js";

/** A frame on disk. */
export interface FrameOnDisk extends Pick<FrameFiles, "input" | "truth"> {
  name: string;
  found: FoundFiles;
}

/** A folder with frames of one object. */
export interface FramesFolder {
  mesh: MeshFile;
  /** The names of the frames, in order. */
  names: readonly string[];
  /** Those that `align` takes: of FoundationPose's layout, those with a mask. */
  views: readonly string[];
  /** Reads a frame. */
  read(name: string): Promise<FrameOnDisk>;
  /** The files beside the frames; without the camera, until a frame was read that has none. */
  found(): FoundFiles;
}

/** Folders of one part in the layout of FoundationPose: their files have the names of the frames. */
const columns: Readonly<Partial<Record<Part, readonly string[]>>> = {
  depth: ["depth", "depths"],
  image: ["rgb", "color", "colour", "image", "images"],
  mask: ["masks", "mask"],
  pose: ["pose", "poses"],
};
/** Folders of the mesh in that layout. */
const meshFolders = ["mesh", "model", "models"];

/** The layout of a folder of frames. */
interface Layout {
  /** The names of the frames, in order. */
  names: readonly string[];
  /** Those that `align` takes. */
  views: readonly string[];
  /** The files of a frame below a folder: their paths, by the names of their parts. */
  filesOf(name: string): Promise<{ place: string; paths: Readonly<Record<string, string>> }>;
  /** The folder of the mesh, below. */
  meshFolder: string;
  /** Folders that are not read. */
  unread: readonly string[];
}

/** The layout of a folder; `undefined` for a case of one view. */
async function layoutOf(folder: string): Promise<Layout | undefined> {
  const entries = await readdir(folder, { withFileTypes: true }).catch(() => []);
  const folders = entries.filter((entry) => entry.isDirectory() || entry.isSymbolicLink()).map(({ name }) => name);
  const names = folders.filter(isFrame).sort(naturally);
  if (names.length > 0) {
    const filesOf = async (name: string) => {
      const place = join(folder, name);
      const paths = await filesBelow(place, "", 1);
      return { place, paths: Object.fromEntries(paths.map((path) => [path, path])) };
    };
    return { ...{ names, views: names, filesOf }, meshFolder: "", unread: [] };
  }
  const isOther = entries.some(({ name }) => partOf(name) === "depth" || isBopScene(name));
  return isOther ? undefined : columnsOf(folder, folders);
}

const isFrame = (path: string) => path.startsWith("frame_");

/** Files of BOP's scenes, which have the same folders. */
const isBopScene = (name: string) => name === "scene_camera.json";

/** The layout of FoundationPose; `undefined` for another. */
async function columnsOf(folder: string, folders: readonly string[]): Promise<Layout | undefined> {
  const columnOf = (part: Part) => folders.find((name) => columns[part]?.includes(name.toLowerCase()));
  if (columnOf("depth") === undefined) return undefined;
  const frames = new Map<string, Record<string, string>>();
  for (const part of Object.keys(columns) as Part[]) {
    const column = columnOf(part);
    for (const file of column === undefined ? [] : await filesBelow(join(folder, column), "", 1)) {
      const { name, ext } = parse(file);
      // The depth comes first: without it, there is no frame.
      const frame = part === "depth" ? {} : frames.get(name);
      if (frame !== undefined && partOf(`${part}${ext}`) === part) {
        frames.set(name, { ...frame, [`${part}${ext}`]: `${column}/${file}` });
      }
    }
  }
  const names = [...frames.keys()].sort(naturally);
  const isMasked = (name: string) => Object.keys(frames.get(name) ?? {}).some((path) => partOf(path) === "mask");
  const meshFolder = folders.find((name) => meshFolders.includes(name.toLowerCase()));
  const used = [meshFolder, ...(Object.keys(columns) as Part[]).map(columnOf)];
  return {
    ...{ names, views: names.filter(isMasked) },
    filesOf: async (name) => ({ place: folder, paths: frames.get(name) ?? {} }),
    meshFolder: meshFolder ?? "",
    unread: folders.filter((name) => !used.includes(name)).map((name) => `${name}/`),
  };
}

/** The names of the frames of a case, in order; none for a case of one view. */
export const frameNames = async (folder: string): Promise<readonly string[]> => (await layoutOf(folder))?.names ?? [];

/**
 * Opens a case folder with `frame_*` folders, or one in the layout of FoundationPose: `depth/`, `rgb/` and `masks/` with a file
 * per frame, and `mesh/`. A camera beside these is that of the frames without one.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function openFrames(folder: string, settings: ReadCaseOptions = {}): Promise<FramesFolder> {
  const layout = await layoutOf(folder);
  const { files: beside, pathOf: sharedPath } = await filesBeside(folder, layout?.meshFolder ?? "");
  const shared = filesOf(beside, settings, folder);
  const meshName = shared.required("mesh");
  const mesh = await meshFile(meshName, await shared.read(meshName), shared.beside);
  let camera: string | undefined;
  return {
    ...{ mesh, names: layout?.names ?? [], views: layout?.views ?? [] },
    async read(name) {
      const { place, paths } = (await layout?.filesOf(name)) ?? { place: folder, paths: {} };
      const above = Object.keys(paths).some((path) => partOf(path) === "camera") ? undefined : shared.find("camera");
      camera ??= above;
      const files: CaseFiles = {
        ...renamed(filesIn("frame", place, Object.values(paths)), paths),
        ...(above === undefined ? {} : { [`../${above}`]: () => shared.read(above) }),
      };
      const { input, truth, ...found } = await frameFrom(files, settings, place);
      const pathOf = (path: string) => paths[path] ?? path;
      const used = Object.entries(found.files).map(([part, path]) => [part, pathOf(path)]);
      const unread = found.unread.map(pathOf);
      return { name, input, truth, found: { folder: place, files: Object.fromEntries(used), unread } };
    },
    found: () => ({
      folder,
      files: withoutUndefined({ mesh: sharedPath(meshName), camera }) as FoundFiles["files"],
      unread: [...shared.unread().map(sharedPath), ...(layout?.unread ?? [])].filter((path) => !isFrame(path)),
    }),
  };
}

/** Files by other names. */
const renamed = (files: CaseFiles, paths: Readonly<Record<string, string>>): CaseFiles =>
  Object.fromEntries(Object.entries(paths).map(([name, path]) => [name, files[path]])) as CaseFiles;

/** The files beside the frames, and their paths. The only mesh in a folder of its own has any name. */
async function filesBeside(folder: string, meshFolder: string) {
  const files = await filesOfCase(folder);
  const place = join(folder, meshFolder);
  const names = meshFolder === "" ? [] : await filesBelow(place, "", LEVELS);
  const nameOf = (name: string) => `mesh${parse(name).ext}`;
  const meshes = names.filter((name) => partOf(nameOf(name)) === "mesh");
  const aliases = names.map((name) => [meshes.length === 1 && name === meshes[0] ? nameOf(name) : name, name]);
  const below = renamed(filesIn("mesh", place, names), Object.fromEntries(aliases));
  const paths: Readonly<Record<string, string>> = Object.fromEntries(
    aliases.map(([alias, name]) => [alias, `${meshFolder}/${name}`]),
  );
  return { files: { ...files, ...below }, pathOf: (name: string) => paths[name] ?? name };
}

/** A frame as an input for `align` and `evaluate`; `undefined` without a mask. */
export function inputOfFrame({ input }: Pick<FrameFiles, "input">, mesh: MeshFile): AlignInput | undefined {
  const { cameraToWorld: _, ...view } = input;
  return view.mask === undefined ? undefined : ({ ...view, mesh } as AlignInput);
}
