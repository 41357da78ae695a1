/** Frames of one object: the files of a folder with a folder or a name for each frame. */
import {
  type CaseFiles,
  type FoundFiles,
  filesOf,
  frameFrom,
  LEVELS,
  meshFile,
  type ReadCaseOptions,
} from "./case-files.js";
import { type Part, partOf } from "./case-names.js";
import type { KnownPose } from "./conventions/pose-file.js";
import { refersToFiles } from "./input/formats.js";
import type { MeshFile, ViewInput } from "./types/inputs.js";
import { naturally } from "./values/order.js";
import { withoutUndefined } from "./values/validation.js";

/** A frame whose files have been read, but not decoded. */
export interface Frame {
  name: string;
  /** The input for a view or, without `cameraToWorld`, for a tracker. */
  input: ViewInput;
  /** The true pose; `null` if unknown. */
  truth: KnownPose | null;
  found: FoundFiles;
}

/** The frames of a folder. */
export interface Frames {
  mesh: MeshFile;
  /** The names of the frames, in order; none for a case of one view. */
  names: readonly string[];
  /** Those that show the object alone: of FoundationPose's layout, those with a mask. */
  views: readonly string[];
  /** Reads a frame. */
  read(name: string): Promise<Frame>;
  /** The files beside the frames; without the camera, until a frame was read that has none. */
  found(): FoundFiles;
}

/** A folder, whose files are listed when they are needed. */
export interface Folder {
  /** Its location, or that of a folder in it, for errors. */
  placeOf(folder?: string): string;
  /** The names in it. */
  entries(): Promise<readonly { name: string; isFolder: boolean }[]>;
  /** The paths of the files in it or a folder in it, relative to that, down to so many levels. */
  below(folder: string, levels: number): Promise<readonly string[]>;
  /** A file in it or in a folder in it. */
  file(folder: string, path: string): CaseFiles[string];
}

/** A folder of files in memory. */
export function folderOf(files: CaseFiles, place = "the files"): Folder {
  const paths = Object.keys(files);
  const within = (folder: string) => (folder === "" ? "" : `${folder}/`);
  const names = new Set(paths.map((path) => /^[^/]*\/?/.exec(path)?.[0] ?? path));
  return {
    placeOf: (folder = "") => (folder === "" ? place : `${place}/${folder}`),
    entries: async () => [...names].map((name) => ({ name: name.replace("/", ""), isFolder: name.endsWith("/") })),
    below: async (folder, levels) =>
      paths
        .filter((path) => path.startsWith(within(folder)))
        .map((path) => path.slice(within(folder).length))
        .filter((path) => path.split("/").length <= levels),
    file: (folder, path) => files[`${within(folder)}${path}`] as CaseFiles[string],
  };
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
  filesOf(name: string): Promise<{ at: string; paths: Readonly<Record<string, string>> }>;
  /** The folder of the mesh, below. */
  meshFolder: string;
  /** Folders that are not read. */
  unread: readonly string[];
}

/** The layout of a folder; `undefined` for a case of one view. */
async function layoutOf(folder: Folder): Promise<Layout | undefined> {
  const entries = await folder.entries();
  const folders = entries.filter(({ isFolder }) => isFolder).map(({ name }) => name);
  const names = folders.filter(isFrame).sort(naturally);
  if (names.length > 0) {
    const filesOf = async (name: string) => {
      const paths = await folder.below(name, 1);
      return { at: name, paths: Object.fromEntries(paths.map((path) => [path, path])) };
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
async function columnsOf(folder: Folder, folders: readonly string[]): Promise<Layout | undefined> {
  const columnOf = (part: Part) => folders.find((name) => columns[part]?.includes(name.toLowerCase()));
  if (columnOf("depth") === undefined) return undefined;
  const frames = new Map<string, Record<string, string>>();
  for (const part of Object.keys(columns) as Part[]) {
    const column = columnOf(part);
    for (const file of column === undefined ? [] : await folder.below(column, 1)) {
      const { name, ext } = parsed(file);
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
    filesOf: async (name) => ({ at: "", paths: frames.get(name) ?? {} }),
    meshFolder: meshFolder ?? "",
    unread: folders.filter((name) => !used.includes(name)).map((name) => `${name}/`),
  };
}

/** The names of the frames of a case, in order; none for a case of one view. */
export const frameNamesIn = async (folder: Folder): Promise<readonly string[]> => (await layoutOf(folder))?.names ?? [];

/**
 * Opens a folder with `frame_*` folders, or one in the layout of FoundationPose: `depth/`, `rgb/` and `masks/` with a file
 * per frame, and `mesh/`. A camera beside these is that of the frames without one.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function framesIn(folder: Folder, settings: ReadCaseOptions): Promise<Frames> {
  const layout = await layoutOf(folder);
  const { files: beside, pathOf: sharedPath } = await filesBeside(folder, layout?.meshFolder ?? "");
  const shared = filesOf(beside, settings, folder.placeOf());
  const meshName = shared.required("mesh");
  const mesh = await meshFile(meshName, await shared.read(meshName), shared.beside);
  let camera: string | undefined;
  return {
    ...{ mesh, names: layout?.names ?? [], views: layout?.views ?? [] },
    async read(name) {
      const { at, paths } = (await layout?.filesOf(name)) ?? { at: "", paths: {} };
      const above = Object.keys(paths).some((path) => partOf(path) === "camera") ? undefined : shared.find("camera");
      camera ??= above;
      const files: CaseFiles = {
        ...renamed(folder, at, Object.entries(paths)),
        ...(above === undefined ? {} : { [`../${above}`]: () => shared.read(above) }),
      };
      const place = folder.placeOf(at);
      const { input, truth, ...found } = await frameFrom(files, settings, place);
      const pathOf = (path: string) => paths[path] ?? path;
      const used = Object.entries(found.files).map(([part, path]) => [part, pathOf(path)]);
      const unread = found.unread.map(pathOf);
      return { name, input, truth, found: { folder: place, files: Object.fromEntries(used), unread } };
    },
    found: () => ({
      folder: folder.placeOf(),
      files: withoutUndefined({ mesh: sharedPath(meshName), camera }) as FoundFiles["files"],
      unread: [...shared.unread().map(sharedPath), ...(layout?.unread ?? [])].filter((path) => !isFrame(path)),
    }),
  };
}

/** The files at paths below a folder, by other names. */
const renamed = (folder: Folder, at: string, paths: readonly (readonly [string, string])[]): CaseFiles =>
  Object.fromEntries(paths.map(([name, path]) => [name, folder.file(at, path)]));

/** The files beside the frames, and their paths. The only mesh in a folder of its own has any name. */
async function filesBeside(folder: Folder, meshFolder: string) {
  const refers = (await folder.entries()).some(({ name }) => partOf(name) === "mesh" && refersToFiles(name));
  const paths = await folder.below("", refers ? LEVELS : 1);
  const files = renamed(
    folder,
    "",
    paths.map((path) => [path, path]),
  );
  const names = meshFolder === "" ? [] : await folder.below(meshFolder, LEVELS);
  const nameOf = (name: string) => `mesh${parsed(name).ext}`;
  const meshes = names.filter((name) => partOf(nameOf(name)) === "mesh");
  const aliases = names.map((name) => [meshes.length === 1 && name === meshes[0] ? nameOf(name) : name, name] as const);
  const pathsOf = new Map(aliases.map(([alias, name]) => [alias, `${meshFolder}/${name}`]));
  return {
    files: { ...files, ...renamed(folder, meshFolder, aliases) },
    pathOf: (name: string) => pathsOf.get(name) ?? name,
  };
}

/** The name of a file without its extension, and the extension with its dot. */
function parsed(path: string) {
  const file = path.slice(path.lastIndexOf("/") + 1);
  const dot = file.lastIndexOf(".");
  return dot > 0 ? { name: file.slice(0, dot), ext: file.slice(dot) } : { name: file, ext: "" };
}
