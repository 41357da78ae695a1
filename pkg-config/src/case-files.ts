/** A case: the files of one observation, one mesh and, if known, the true pose. */
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import { numbersIn, parsedJson, shown } from "./formats/json.js";
import { requiredBytes } from "./input/bytes.js";
import type { AlignInput, DepthKind, EncodedBytes, MeshFile, MeshFormat, ViewInput } from "./input/types.js";
import type { LoadFormats } from "./modules/readers.js";
import { failure, Sim3AlignError } from "./values/error.js";
import { isRecord, record, withoutUndefined } from "./values/values.js";

/** Files by name, relative to the folder of the case or scene: bytes, or a function that reads them on demand. */
export type CaseFiles = Readonly<Record<string, EncodedBytes | (() => Promise<EncodedBytes>)>>;

/** How to read the files of a case or scene. */
export type ReadCaseOptions = Partial<Pick<AlignInput, "depthScale" | "imageId" | "resizeMask">> & {
  /** What the values of the depth map are; `"metric"` by default. */
  depthKind?: DepthKind | undefined;
  /** Whether to read the photo; `true` by default. */
  image?: boolean | undefined;
};

/** A case whose files have been read, but not decoded. */
export interface Case {
  /** The input for `align` and `evaluate`. */
  input: AlignInput;
  /** The name of the file of each part of the input; of the camera and of the photo, if there is one. */
  files: Record<"depth" | "mask" | "mesh", string> & { camera?: string; image?: string };
  /** The true pose; `null` if unknown. */
  truth: KnownPose | null;
}

/** File names of each part of a case. */
export const caseFiles = {
  depth: ["depth.npy", "depth.png", "depth.npz", "depth.exr", "depth.tiff", "depth.tif", "depth.pfm"],
  mask: ["mask.png", "mask.npy", "mask.json"],
  mesh: ["mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl", "mesh.splat"],
  camera: ["camera.json", "scene_camera.json"],
  image: ["rgb.png", "rgb.jpg", "rgb.jpeg", "image.png", "image.jpg", "image.jpeg"],
} as const satisfies { mesh: readonly `mesh.${MeshFormat}`[]; [part: string]: readonly string[] };

/** The file of an object of a scene with a first pose: one candidate among those of the search. */
export const INITIAL_FILE = "initial.json";

/** Frames whose files have been read, but not decoded. */
export interface FrameFiles {
  /** The input for a view or a tracker. */
  input: ViewInput;
  /** The name of the file of each part of the input. */
  files: Readonly<Record<string, string>>;
  /** The true pose; `null` if unknown. */
  truth: KnownPose | null;
}

/** The file with the pose of a frame's camera, and the camera's pose in it: `camera_to_world`, 4×4 by rows, metres. */
const CAMERA_POSE_FILE = "pose.json";

/**
 * Reads a frame: depth map, and optionally camera file, mask, photo, `pose.json` and `gt.json`, identified by name.
 * @param place location of the files, for errors
 * @internal
 */
export async function frameFrom(files: CaseFiles, settings: ReadCaseOptions, place: string): Promise<FrameFiles> {
  const reader = filesOf(files, settings, place);
  const names = { depth: reader.required("depth"), mask: reader.find("mask"), ...reader.viewNames() };
  const { input, truth } = await viewFrom(reader, names, settings);
  const pose = await reader.optional(CAMERA_POSE_FILE);
  if (pose !== undefined) input.cameraToWorld = cameraPose(pose);
  return { input, files: withoutUndefined(names) as FrameFiles["files"], truth };
}

/** Reads the view in files of these names, and its true pose. */
async function viewFrom(
  { read, optional }: ReturnType<typeof filesOf>,
  names: { depth: string; mask: string | undefined; camera?: string; image?: string },
  { image: _, ...settings }: ReadCaseOptions,
) {
  const [depth, mask, cameraFile, image, truth] = await Promise.all([
    ...[read(names.depth), optional(names.mask), optional(names.camera), optional(names.image)],
    optional("gt.json"),
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
  /** The name of a part's file; that of the photo only if it is wanted. */
  const find = (part: keyof typeof caseFiles) =>
    part === "image" && !image ? undefined : onlyFile(part, (name) => name in files, place, owner);
  const required = (part: keyof typeof caseFiles) => {
    const name = find(part);
    if (name !== undefined) return name;
    throw fileNotFound(owner ?? part, `no such file in ${place}`, caseFiles[part].join(" or "));
  };
  const viewNames = () => withoutUndefined({ camera: find("camera"), image: find("image") });
  const read = async (name: string) => {
    const file = files[name];
    return requiredBytes(name, typeof file === "function" ? await file() : file);
  };
  const optional = (name: string | undefined) => (name !== undefined && name in files ? read(name) : undefined);
  /** Reads a file that the mesh refers to. */
  const beside = async (path: string) => {
    if (path in files) return read(path);
    throw fileNotFound("mesh", `no ${path} in ${place}`, "the files that the mesh refers to");
  };
  return { find, required, viewNames, read, optional, beside };
}

function cameraPose(bytes: Uint8Array): number[] {
  const json = parsedJson("pose", bytes);
  const rows = isRecord(json) ? numbersIn(json.camera_to_world, 16) : null;
  if (rows !== null) return Array.from(rows, (_, i) => rows[4 * (i % 4) + Math.floor(i / 4)] as number);
  const expected = '{ "camera_to_world": 4 × 4 numbers, row by row }';
  const remedy = "The matrix maps points of the camera (x right, y down, z forward) to the world, in metres.";
  throw failure("CORRUPT_FILE", "pose", isRecord(json) ? shown(json.camera_to_world) : shown(json), expected, remedy);
}

/**
 * Reads a case: depth map, mask, mesh, and optionally camera file, photo and `gt.json`, identified by name.
 * @param place location of the files, for errors
 * @internal
 */
export async function caseFrom(
  files: CaseFiles,
  settings: ReadCaseOptions,
  formats: LoadFormats,
  place = "the files",
): Promise<Case> {
  const reader = filesOf(files, settings, place);
  const { required, viewNames } = reader;
  const names = { depth: required("depth"), mask: required("mask"), mesh: required("mesh"), ...viewNames() };
  const { input, truth } = await viewFrom(reader, names, settings);
  const mesh = await meshFile(names.mesh, await reader.read(names.mesh), formats, reader.beside);
  return { input: { ...input, mesh } as AlignInput, files: names, truth };
}

/**
 * Reads a mesh file as an input. The extension determines the format; the files that a `.gltf` or an `.obj` refers to are
 * read from its folder.
 * @param read returns the bytes of a file, by its path relative to the folder of the mesh
 * @internal
 */
export async function meshFile(
  name: string,
  bytes: Uint8Array,
  formats: LoadFormats,
  read: (path: string) => Promise<Uint8Array>,
): Promise<MeshFile> {
  const format = /\.([^./\\]+)$/.exec(name)?.[1]?.toLowerCase() as MeshFormat | undefined;
  if (!caseFiles.mesh.some((known) => known === `mesh.${format}`)) return { bytes };
  if (format !== "gltf" && format !== "obj") return { bytes, format };
  const resources: Record<string, Uint8Array> = {};
  const readers = await formats();
  const namesIn = (file: Uint8Array) => readers.call((module) => module.externalResources(file));
  const { shape, colors } = namesIn(bytes);
  for (const uri of shape) {
    const path = pathBelow(uri);
    if (path === undefined) throw outside(uri);
    resources[uri] = await read(path);
  }
  const readOptional = async (uri: string) => {
    const path = pathBelow(uri);
    const file = path === undefined ? undefined : await read(path).catch(unlessMissing);
    if (file !== undefined) resources[uri] = file;
    return file;
  };
  for (const uri of colors) {
    const file = await readOptional(uri);
    // The material libraries of an OBJ refer to textures.
    if (file === undefined || format === "gltf") continue;
    for (const texture of namesIn(file).colors) await readOptional(texture);
  }
  return { bytes, format, resources };
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
  const expected = "a path in the folder of the .gltf, or below it";
  const remedy = "Put the buffers next to the .gltf, or convert it to a single .glb.";
  return failure("CORRUPT_FILE", "mesh", `a buffer at ${JSON.stringify(uri)}`, expected, remedy);
}

function decoded(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/**
 * The name of the file of a part; `undefined` without one.
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` if several files have names of the part: none is better than another
 * @internal
 */
export function onlyFile(
  part: keyof typeof caseFiles,
  isThere: (name: string) => boolean,
  place: string,
  owner: string = part,
): string | undefined {
  const names = caseFiles[part].filter(isThere);
  if (names.length < 2) return names[0];
  const remedy = `Remove or rename the others; on the command line, --${part} names one, with --depth, --mask and --mesh.`;
  throw failure("INVALID_ARGUMENT", owner, `${names.join(" and ")} in ${place}`, "one of them", remedy);
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
