/** A case: the files of one observation, one mesh and, if known, the true pose. */
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import { Sim3AlignError } from "./error.js";
import type { LoadFormats } from "./formats-module.js";
import { requiredBytes } from "./input/bytes.js";
import type { AlignInput, EncodedBytes, MeshFile, MeshFormat } from "./input/types.js";

/** Files by name, relative to the folder of the case: bytes, or a function that reads them on demand. */
export type CaseFiles = Readonly<Record<string, EncodedBytes | (() => Promise<EncodedBytes>)>>;

/** How to read the files of a case. */
export type CaseSettings = Partial<Pick<AlignInput, "depthScale" | "imageId" | "resizeMask">>;

/** A case whose files have been read, but not decoded. */
export interface Case {
  /** The input for `align` and `evaluate`. */
  input: AlignInput;
  /** The name of the file of each part of the input. */
  files: Record<keyof typeof caseFiles, string>;
  /** The true pose; `null` if unknown. */
  truth: KnownPose | null;
}

/** File names of each part of a case, in order of preference. */
export const caseFiles = {
  depth: ["depth.npy", "depth.png"],
  mask: ["mask.png", "mask.npy", "mask.json"],
  mesh: ["mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl"],
  camera: ["camera.json", "scene_camera.json"],
} as const;

const meshFormats: readonly string[] = ["glb", "gltf", "obj", "ply", "stl"] satisfies MeshFormat[];

/**
 * Reads a case: depth map, mask, mesh, camera file and `gt.json`, identified by name.
 * @param place location of the files, for errors
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
 * Reads a mesh file as an input. The extension determines the format; the buffers of a `.gltf` are read from its
 * folder.
 * @param read returns the bytes of a file, by its path relative to the folder of the mesh
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

/** The path of a URI in a `.gltf`. Paths outside its folder are rejected, because the file may be malicious. */
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
    expected: "a path in the folder of the .gltf, or below it",
    remedy: "Put the buffers next to the .gltf, or convert it to a single .glb.",
  });
}

function decoded(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/** The error for a missing file of a case. */
export function fileNotFound(argument: string, found: string, expected: string, cause?: unknown): Sim3AlignError {
  const remedy = 'See "sim3align align --help" for the layout of a case folder.';
  return new Sim3AlignError({ code: "FILE_NOT_FOUND", argument, found, expected, remedy }, { cause });
}
