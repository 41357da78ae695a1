/** A case on disk (Node only): a folder with depth, mask, mesh, camera and, where it is known, the true pose. */
import { readdir, readFile } from "node:fs/promises";
import { basename, dirname, extname, isAbsolute, join, relative, resolve } from "node:path";
import { Sim3AlignError } from "./error.js";
import type { AlignInput, CameraInput, MeshFormat } from "./input/types.js";
import { formatsModule } from "./modules.js";

/** A case whose files have been read, not decoded. */
export interface Case {
  name: string;
  input: AlignInput;
  /** The file that each part of the input comes from. */
  files: Readonly<Record<string, string>>;
  /** The true pose, where the case has one. */
  truth: Truth | null;
}

/** A known pose, and whether the object has symmetries to be found. */
export interface Truth {
  matrix: number[];
  symmetry: "none" | "auto" | "auto-revolution";
}

/** The files that hold each part of a case, in order of preference. */
export const caseFiles = {
  depth: ["depth.npy", "depth.png"],
  mask: ["mask.png", "mask.npy", "mask.json"],
  mesh: ["mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl"],
  camera: ["camera.json", "scene_camera.json"],
} as const;

/** The parts of a case as they were named one by one. */
export interface CasePaths {
  depth: string;
  mask: string;
  mesh: string;
  /** A file, or the camera itself. */
  camera: string | { value: CameraInput };
}

/** What is said about a case beside its files. */
export type CaseSettings = Partial<Pick<AlignInput, "depthScale" | "imageId" | "resizeMask">>;

/**
 * Reads a case folder.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the names that were looked for
 */
export async function readCaseFolder(folder: string, settings: CaseSettings = {}): Promise<Case> {
  const names = await readdir(folder).catch((cause) => {
    throw notFound("case", folder, "a folder with depth, mask, mesh and camera", cause);
  });
  const find = (part: keyof typeof caseFiles) => {
    const name = caseFiles[part].find((candidate) => names.includes(candidate));
    if (name !== undefined) return join(folder, name);
    throw notFound(part, folder, caseFiles[part].join(" or "));
  };
  const paths = { depth: find("depth"), mask: find("mask"), mesh: find("mesh"), camera: find("camera") };
  const truth = names.includes("gt.json") ? await readTruth(join(folder, "gt.json")) : null;
  return { ...(await readCaseFiles(basename(resolve(folder)), paths, settings)), truth };
}

/** Reads a case from files named one by one. */
export async function readCaseFiles(name: string, paths: CasePaths, settings: CaseSettings = {}): Promise<Case> {
  const { camera } = paths;
  const [depth, mask, mesh, cameraInput] = await Promise.all([
    read("depth", paths.depth),
    read("mask", paths.mask),
    readMeshFile(paths.mesh),
    typeof camera === "string" ? read("camera", camera) : camera.value,
  ]);
  const files = { depth: paths.depth, mask: paths.mask, mesh: paths.mesh };
  return {
    name,
    input: { depth, mask, mesh, camera: cameraInput, ...settings } as AlignInput,
    files: typeof camera === "string" ? { ...files, camera } : files,
    truth: null,
  };
}

/** A known pose; `null` where the file says that none is known. */
export async function readTruth(path: string): Promise<Truth | null> {
  const bytes = await read("truth", path);
  const module = await formatsModule.load();
  const truth = module.call((readers) => readers.readTruth(bytes));
  if (truth === null) return null;
  return { matrix: Array.from(truth.matrix), symmetry: symmetryOf(truth.symmetry.trim().toLowerCase()) };
}

/** What a data set's words say about symmetry. */
function symmetryOf(words: string): Truth["symmetry"] {
  if (words.startsWith("continuous")) return "auto-revolution";
  return words.startsWith("discrete") ? "auto" : "none";
}

/** A file's bytes. */
export async function read(argument: string, path: string): Promise<Uint8Array> {
  try {
    return await readFile(path);
  } catch (cause) {
    throw notFound(argument, path, "a file that can be read", cause);
  }
}

const meshFormats: readonly string[] = ["glb", "gltf", "obj", "ply", "stl"] satisfies MeshFormat[];

/** A mesh file, with the files that a `.gltf` keeps its buffers in. */
async function readMeshFile(path: string) {
  const bytes = await read("mesh", path);
  const extension = extname(path).slice(1).toLowerCase();
  if (!meshFormats.includes(extension)) return { bytes };
  const format = extension as MeshFormat;
  if (format !== "gltf") return { bytes, format };
  const module = await formatsModule.load();
  const uris = module.call((readers) => readers.externalResources(bytes));
  const folder = dirname(path);
  const resources: Record<string, Uint8Array> = {};
  for (const uri of uris) {
    const file = join(folder, decodeURIComponent(uri));
    resources[uri] = await read("mesh", checkedBelow(folder, file, uri));
  }
  return { bytes, format, resources };
}

/** A file that names others is not to be trusted with the whole disk. */
function checkedBelow(folder: string, file: string, uri: string): string {
  const path = relative(folder, file);
  if (path !== "" && !path.startsWith("..") && !isAbsolute(path)) return file;
  throw new Sim3AlignError({
    code: "CORRUPT_FILE",
    argument: "mesh",
    found: `a buffer at ${JSON.stringify(uri)}`,
    expected: "one in the folder of the .gltf, or below it",
    remedy: "Put the buffers beside the .gltf, or pack everything into one .glb.",
  });
}

function notFound(argument: string, path: string, expected: string, cause?: unknown): Sim3AlignError {
  const reason = cause instanceof Error && "code" in cause && cause.code !== "ENOENT" ? ` (${cause.code})` : "";
  return new Sim3AlignError(
    {
      code: "FILE_NOT_FOUND",
      argument,
      found: cause === undefined ? `no such file in ${path}` : `nothing to read at ${path}${reason}`,
      expected,
      remedy: 'See "sim3align align --help" for the layout of a case folder.',
    },
    { cause },
  );
}
