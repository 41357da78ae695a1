/** A case: the files of one observation, one mesh and, where it is known, the true pose. */
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import { Sim3AlignError } from "./error.js";
import type { LoadFormats } from "./formats-module.js";
import { requiredBytes } from "./input/bytes.js";
import type { AlignInput, EncodedBytes, MeshFile, MeshFormat } from "./input/types.js";

/** Files by their names, relative to the case's folder: bytes, or a function that reads them when they are needed. */
export type CaseFiles = Readonly<Record<string, EncodedBytes | (() => Promise<EncodedBytes>)>>;

/** How to read the files of a case. */
export type CaseSettings = Partial<Pick<AlignInput, "depthScale" | "imageId" | "resizeMask">>;

/** A case whose files have been read, but not decoded. */
export interface Case {
  /** What `align` and `evaluate` take. */
  input: AlignInput;
  /** The name of the file that each part of the input comes from. */
  files: Record<keyof typeof caseFiles, string>;
  /** The true pose; `null` where the case has none. */
  truth: KnownPose | null;
}

/** The names of the files that hold each part of a case, in order of preference. */
export const caseFiles = {
  depth: ["depth.npy", "depth.png"],
  mask: ["mask.png", "mask.npy", "mask.json"],
  mesh: ["mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl"],
  camera: ["camera.json", "scene_camera.json"],
} as const;

const meshFormats: readonly string[] = ["glb", "gltf", "obj", "ply", "stl"] satisfies MeshFormat[];

/**
 * Reads a case: depth map, mask, mesh, camera file and `gt.json`, known by their names.
 * @param place of the files, for errors
 * @internal
 */
export async function caseFrom(
  files: CaseFiles,
  settings: CaseSettings,
  formats: LoadFormats,
  place = "the files",
): Promise<Case> {
  const find = (part: keyof typeof caseFiles) => {
    const name = caseFiles[part].find((candidate) => candidate in files);
    if (name !== undefined) return name;
    throw fileNotFound(part, `no such file in ${place}`, caseFiles[part].join(" or "));
  };
  const names = { depth: find("depth"), mask: find("mask"), mesh: find("mesh"), camera: find("camera") };
  const read = async (name: string) => {
    const file = files[name];
    return requiredBytes(name, typeof file === "function" ? await file() : file);
  };
  const [depth, mask, meshBytes, cameraFile, truth] = await Promise.all([
    ...[read(names.depth), read(names.mask), read(names.mesh), read(names.camera)],
    "gt.json" in files ? read("gt.json") : undefined,
  ]);
  const mesh = await meshFile(names.mesh, meshBytes as Uint8Array, formats, async (path) => {
    if (path in files) return read(path);
    throw fileNotFound("mesh", `no ${path} in ${place}`, `the buffers of ${names.mesh}`);
  });
  const input = { depth, mask, mesh, cameraFile, ...settings } as AlignInput;
  return { input, files: names, truth: truth === undefined ? null : parsePoseFile("truth", truth) };
}

/**
 * A mesh file as an input: its format is that of its name, and the buffers of a `.gltf` come from beside it.
 * @param read gives the bytes of a file by its path, relative to the mesh's folder
 * @internal
 */
export async function meshFile(
  name: string,
  bytes: Uint8Array,
  formats: LoadFormats,
  read: (path: string) => Promise<Uint8Array>,
): Promise<MeshFile> {
  const extension = /\.([^./\\]+)$/.exec(name)?.[1]?.toLowerCase() ?? "";
  if (!meshFormats.includes(extension)) return { bytes };
  const format = extension as MeshFormat;
  if (format !== "gltf") return { bytes, format };
  const uris = (await formats()).call((readers) => readers.externalResources(bytes));
  const resources: Record<string, Uint8Array> = {};
  for (const uri of uris) resources[uri] = await read(pathBelow(uri));
  return { bytes, format, resources };
}

/** The path that a URI in a `.gltf` names. A file that names others is not trusted with the whole disk. */
function pathBelow(uri: string): string {
  const parts = decoded(uri)
    .split(/[/\\]/)
    .filter((part) => part !== ".");
  const isBelow = parts.every((part) => part !== ".." && part !== "" && !part.includes(":"));
  if (isBelow && parts.length > 0) return parts.join("/");
  throw new Sim3AlignError({
    code: "CORRUPT_FILE",
    argument: "mesh",
    found: `a buffer at ${JSON.stringify(uri)}`,
    expected: "one in the folder of the .gltf, or below it",
    remedy: "Put the buffers beside the .gltf, or pack everything into one .glb.",
  });
}

function decoded(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/** The error for a file of a case that is not there. */
export function fileNotFound(argument: string, found: string, expected: string, cause?: unknown): Sim3AlignError {
  const remedy = 'See "sim3align align --help" for the layout of a case folder.';
  return new Sim3AlignError({ code: "FILE_NOT_FOUND", argument, found, expected, remedy }, { cause });
}
