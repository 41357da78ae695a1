/** A case: the files of one observation, one mesh and, if known, the true pose. */
import { fileOf, isNoInput, namesOf, type Part, partOf } from "./case-names.js";
import { parseCameraPose } from "./conventions/camera-pose-file.js";
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import { requiredBytes } from "./input/bytes.js";
import { refersToFiles } from "./input/formats.js";
import { gltfText } from "./input/webp.js";
import { formatsModule } from "./modules/readers.js";
import type {
  AlignInput,
  DepthCoding,
  DepthKind,
  EncodedBytes,
  MeshFile,
  MeshFormat,
  ViewInput,
} from "./types/inputs.js";
import { failure, Sim3AlignError } from "./values/error.js";
import { naturally } from "./values/order.js";
import { record, withoutUndefined } from "./values/validation.js";

/** Depth of the folders that are searched for the files of a mesh. */
export const LEVELS = 8;

/** Files by name, relative to the folder of the case or scene: bytes, or a function that reads them on demand. */
export type CaseFiles = Readonly<Record<string, EncodedBytes | (() => Promise<EncodedBytes>)>>;

/** Reads a file on disk; one that another file refers to may not be a link out of its folder. */
export type ReadOnDisk = (isReferred?: boolean) => Promise<EncodedBytes>;

/** How to read the files of a case or scene. */
export type ReadCaseOptions = Partial<Pick<AlignInput, "depthScale" | "imageId" | "resizeMask" | "maskIndex">> &
  DepthCoding & {
    /** What the values of the depth map are; `"metric"` by default. */
    depthKind?: DepthKind | undefined;
    /** Whether to read the photo; `true` by default. */
    image?: boolean | undefined;
  };

/** A case whose files have been read, but not decoded. */
export interface Case {
  /** The input for `align` and `evaluate`. */
  input: AlignInput;
  /** The name of the file of each part; of the camera, of the photo and of the true pose, if there is one. */
  files: Record<"depth" | "mask" | "mesh", string> & { camera?: string; image?: string; truth?: string };
  /** The names of files that were not read, in order. */
  unread: string[];
  /** The true pose; `null` if unknown. Its `transform` is the option `truth` of `evaluate`. */
  truth: KnownPose | null;
}

/** The files of a folder: which each part is, and those that were not read. Names are relative to the folder. */
export interface FoundFiles {
  folder: string;
  files: Readonly<Record<string, string>>;
  unread: readonly string[];
}

/** Frames whose files have been read, but not decoded. */
export interface FrameFiles extends Pick<Case, "unread" | "truth"> {
  /** The input for a view or a tracker. */
  input: ViewInput;
  /** The name of the file of each part. */
  files: Readonly<Record<string, string>>;
}

/**
 * Reads a frame: depth map, and optionally camera file, mask, photo, `pose.json` and `gt.json`, identified by name.
 * @param place location of the files, for errors
 * @internal
 */
export async function frameFrom(files: CaseFiles, settings: ReadCaseOptions, place: string): Promise<FrameFiles> {
  const reader = filesOf(files, settings, place);
  const { find, required, optional } = reader;
  const names = { depth: required("depth"), mask: find("mask"), ...reader.viewNames(), pose: find("pose") };
  const { input, truth } = await viewFrom(reader, names, settings);
  const pose = await optional(names.pose);
  if (pose !== undefined) input.cameraToWorld = parseCameraPose("pose", pose);
  return { input, files: withoutUndefined(names) as FrameFiles["files"], unread: reader.unread(), truth };
}

/** Reads the view in files of these names, and its true pose. */
async function viewFrom(
  { read, optional }: ReturnType<typeof filesOf>,
  names: { depth: string; mask: string | undefined; camera?: string; image?: string; truth?: string },
  { image: _, ...settings }: ReadCaseOptions,
) {
  const [depth, mask, cameraFile, image, truth] = await Promise.all([
    ...[read(names.depth), optional(names.mask), optional(names.camera), optional(names.image)],
    optional(names.truth),
  ]);
  const input = withoutUndefined({ depth, mask, cameraFile, image, ...settings }) as ViewInput;
  return { input, truth: truth === undefined ? null : parsePoseFile("truth", truth) };
}

/**
 * Finds and reads the files of a case.
 * @param owner whose parts they are, in errors; by default, the parts themselves
 * @internal
 */
export function filesOf(files: CaseFiles, { image = true }: ReadCaseOptions, place: string, owner?: string) {
  const all = Object.keys(files);
  const used = new Set<string>();
  const isWanted = (part: Part | undefined) => image || part !== "image";
  /** The name of a part's file; that of the photo only if it is wanted. */
  const find = (part: Part) => (isWanted(part) ? fileOf(part, all, place, owner) : undefined);
  /** The names of files that were not read, in order. */
  const unread = () =>
    all.filter((name) => !used.has(name) && !isNoInput(name) && isWanted(partOf(name))).sort(naturally);
  const required = (part: Part) => {
    const name = find(part);
    if (name !== undefined) return name;
    const others = unread().filter((other) => partOf(other) === undefined);
    const found = `no ${part} file in ${place}${others.length === 0 ? "" : `, beside ${listed(others)}`}`;
    throw fileNotFound(owner ?? part, found, namesOf(part).join(" or "));
  };
  const viewNames = () => withoutUndefined({ camera: find("camera"), image: find("image"), truth: find("truth") });
  const read = async (name: string, isReferred = false) => {
    used.add(name);
    const file: CaseFiles[string] | ReadOnDisk | undefined = files[name];
    return requiredBytes(name, typeof file === "function" ? await file(isReferred) : file);
  };
  const optional = async (name: string | undefined) => (name === undefined ? undefined : read(name));
  /** Reads a file that the mesh refers to. */
  const beside = async (path: string) => {
    if (path in files) return read(path, true);
    throw fileNotFound("mesh", `no ${path} in ${place}`, "the files that the mesh refers to");
  };
  return { find, required, viewNames, read, optional, beside, unread };
}

/** Maximum number of names in a sentence. */
const LISTED = 10;

/** Names in a sentence, the first ten of many. */
export const listed = (names: readonly string[]): string =>
  names.length > LISTED ? `${names.slice(0, LISTED).join(", ")} and ${names.length - LISTED} more` : names.join(", ");

/**
 * Reads a case: depth map, mask, mesh, and optionally camera file, photo and `gt.json`, identified by name.
 * @param place location of the files, for errors
 * @internal
 */
export async function caseFrom(files: CaseFiles, settings: ReadCaseOptions, place = "the files"): Promise<Case> {
  const reader = filesOf(files, settings, place);
  const { required, viewNames } = reader;
  const names = { depth: required("depth"), mask: required("mask"), mesh: required("mesh"), ...viewNames() };
  const { input, truth } = await viewFrom(reader, names, settings);
  const mesh = await meshFile(names.mesh, await reader.read(names.mesh), reader.beside);
  return { input: { ...input, mesh } as AlignInput, files: names, unread: reader.unread(), truth };
}

/**
 * Reads a mesh file as an input. The extension determines the format; the files that a glTF, OBJ or PLY file refers to are read
 * from its folder.
 * @param read returns the bytes of a file, by its path relative to the folder of the mesh
 * @internal
 */
export async function meshFile(
  name: string,
  bytes: Uint8Array,
  read: (path: string) => Promise<Uint8Array>,
): Promise<MeshFile> {
  const format = /\.([^./\\]+)$/.exec(name)?.[1]?.toLowerCase() as MeshFormat | undefined;
  if (format === undefined || partOf(`mesh.${format}`) !== "mesh") return { bytes };
  if (!refersToFiles(name)) return { bytes, format };
  const resources: Record<string, Uint8Array> = {};
  const readers = await formatsModule.load();
  const resourcesOf = (file: Uint8Array) => readers.call((module) => module.externalResources(file));
  const readOptional = async (uri: string) => {
    const path = pathBelow(uri);
    const file = path === undefined ? undefined : await read(path).catch(unlessMissing);
    if (file !== undefined) resources[uri] = file;
    return file;
  };
  const { shape, colors } = resourcesOf(bytes);
  // With meshopt, some hold what decoders do not need.
  const isFallback = gltfText(bytes).includes("_meshopt_");
  for (const uri of shape) {
    const path = pathBelow(uri);
    if (path === undefined) throw outside(uri);
    if (isFallback) await readOptional(uri);
    else resources[uri] = await read(path);
  }
  for (const uri of colors) {
    const file = await readOptional(uri);
    // The material libraries of an OBJ refer to textures.
    if (file === undefined || format !== "obj") continue;
    for (const texture of resourcesOf(file).colors) await readOptional(texture);
  }
  return Object.keys(resources).length === 0 ? { bytes, format } : { bytes, format, resources };
}

/** A mesh without its textures is aligned by its shape, and the reader warns of what is missing. */
function unlessMissing(error: unknown): undefined {
  if (!(error instanceof Sim3AlignError && error.code === "FILE_NOT_FOUND")) throw error;
}

/** The path of a URI in a mesh file; `undefined` outside its folder, because the file may be malicious. */
function pathBelow(uri: string): string | undefined {
  const parts = decoded(uri)
    .split(/[/\\]/)
    .filter((part) => part !== ".");
  const isBelow = parts.every((part) => part !== ".." && part !== "" && !part.includes(":"));
  return isBelow && parts.length > 0 ? parts.join("/") : undefined;
}

function outside(uri: string): Sim3AlignError {
  const expected = "a path in the folder of the mesh, or below it";
  const remedy = "Put the buffers next to it, or convert it to a single .glb.";
  return failure("CORRUPT_FILE", "mesh", `a buffer at ${JSON.stringify(uri)}`, expected, remedy);
}

function decoded(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/** The files of a call, read once. */
export function ownFiles(files: CaseFiles): CaseFiles {
  return record("files", files, "files by name") as CaseFiles;
}

/** The error for a missing file of a case. */
export function fileNotFound(argument: string, found: string, expected: string, cause?: unknown): Sim3AlignError {
  const remedy = 'See "sim3align align --help" for the layout of a case folder.';
  return failure("FILE_NOT_FOUND", argument, found, expected, remedy, cause);
}
