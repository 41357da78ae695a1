/** Transforms from files: of one pose, and of the results of a batch. */
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { isPose, parsePoseFile, poseJson } from "../conventions/pose-file.js";
import { checksumOf, read, readOncePerKey } from "../read-files.js";
import type { MeshFile } from "../types/inputs.js";
import { failure, Sim3AlignError } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import type { Entry } from "./entry.js";
import { bytesOf, isFile, realPath } from "./files.js";
import { linesIn } from "./lines.js";
import { type CaseKey, isRecordText } from "./record.js";

const remedy = 'See "sim3align evaluate --help" for the layout of a transform file.';

/** The entry of a case in the results of a batch. */
interface BatchEntry {
  name: string;
  /** The absolute path of the case. */
  path: string | undefined;
  /** Its entry; that of a record is read from its line. */
  read(): unknown;
}

/** The content of a transform file: a pose, or the entries of a batch. */
type TransformFile = { pose: object } | { entries: readonly BatchEntry[] };

/** Each file is read once, for all cases. */
const contents = { transform: contentsOf("transform"), initial: contentsOf("initial") };

function contentsOf(argument: "transform" | "initial") {
  return readOncePerKey(async (path: string): Promise<TransformFile> => {
    try {
      const isOfBatch = isFile(path) && isRecordText(bytesOf(path, 0, 16).toString());
      return await (isOfBatch ? recordIn : poseOrResultsIn)(path, argument);
    } catch (cause) {
      if (cause instanceof Sim3AlignError) throw cause;
      throw failure("CORRUPT_FILE", argument, `${path}: ${(cause as Error).message}`, "JSON", remedy, cause);
    }
  });
}

/**
 * Reads a transform file as 16 numbers, column-major.
 * @param argument the name of the transform in errors
 * @param key the case, whose entry is read from the output of `align --json` or from a record: that of its path, or of its name
 * if the file has no path for it
 * @param mesh the mesh of the case: a record has checksums, and a pose of another mesh is refused
 * @param frame its frame, whose pose is read from that entry
 */
export async function readTransform(
  argument: "transform" | "initial",
  path: string,
  key: Pick<CaseKey, "name" | "path">,
  mesh: unknown,
  frame?: string,
): Promise<number[]> {
  const invalid = (found: string, expected: string) => failure("INVALID_TRANSFORM", argument, found, expected, remedy);
  const content = await contents[argument](path);
  const own = "pose" in content ? content.pose : entryOf(content.entries, key, invalid);
  checkMesh(own, mesh, key.name, invalid);
  const frames = frame === undefined ? undefined : framesOf(own);
  const entry = frame === undefined || frames === undefined ? own : poseIn(frames[frame], frame, invalid);
  const pose = parsePoseFile(argument, entry);
  if (pose === null) throw invalid("a file without a known pose", "a transform");
  return Array.from(pose.transform.matrix);
}

/** A pose, or the results of --json. */
async function poseOrResultsIn(path: string, argument: string): Promise<TransformFile> {
  const json = poseJson(argument, await read(argument, path));
  // Cases may have the names of the parts of a pose, too.
  if (Array.isArray(json) || (isRecord(json) && isPose(json))) return { pose: json };
  if (!isRecord(json)) throw new Error(`${JSON.stringify(json)} is no transform`);
  const absolute = absoluteFrom(path);
  const entries = Object.entries(json).map(([name, entry]) => {
    return { name, path: isRecord(entry) ? absolute(entry.path) : undefined, read: () => entry };
  });
  return { entries };
}

/** The entries of a record. Of a case that it has twice, the last line counts. */
async function recordIn(path: string, argument: string): Promise<TransformFile> {
  const absolute = absoluteFrom(path);
  const tooLong = (problem: string) =>
    failure("FILE_TOO_LARGE", argument, `${path}: ${problem}`, "lines of a record", remedy);
  const entries: BatchEntry[] = [];
  for await (const { bytes, start, number } of linesIn(path, tooLong)) {
    const line = bytes.toString();
    if (line.trim() === "" || line.startsWith('{"sim3align":')) continue;
    const row: unknown = JSON.parse(line);
    if (!isRecord(row)) throw new Error(`line ${number} is no object`);
    const read = () => JSON.parse(bytesOf(path, start, bytes.length).toString());
    entries.push({ name: String(row.case), path: absolute(row.path), read });
  }
  return { entries: entries.reverse() };
}

/** Makes the paths in an output absolute. */
function absoluteFrom(output: string) {
  const folder = realPath(dirname(output));
  return (relative: unknown) => (typeof relative === "string" ? join(folder, relative) : undefined);
}

/**
 * Refuses the pose of another mesh, if the entry has checksums of its files. Images beside a mesh do not count.
 * @throws {@link Sim3AlignError} `INVALID_TRANSFORM`
 */
function checkMesh(entry: object, mesh: unknown, name: string, invalid: Invalid): void {
  const { files } = entry as Entry;
  const { bytes, resources = {} } = mesh as Partial<MeshFile>;
  if (!isRecord(files) || bytes === undefined) return;
  const buffers = Object.entries(resources).flatMap(([path, buffer]) => (path.endsWith(".bin") ? [buffer] : []));
  const known = new Set(Object.values(files));
  if ([bytes, ...buffers].every((part) => known.has(checksumOf(part as Uint8Array)))) return;
  throw invalid(
    `a pose of another mesh for ${name}`,
    "a pose of its mesh; align it again, or pass a file of the pose alone",
  );
}

type Invalid = (found: string, expected: string) => Error;

function entryOf(entries: readonly BatchEntry[], { name, path }: Pick<CaseKey, "name" | "path">, invalid: Invalid) {
  const named = entries.find((entry) => entry.name === name);
  const found = entries.find((entry) => path !== undefined && entry.path === path) ?? named;
  if (found === undefined) {
    const names = entries.map((entry) => entry.name).slice(0, 12);
    throw invalid(`an object with ${names.join(", ") || "nothing"}`, `a transform, or an entry for ${name}`);
  }
  // A case that has moved has its old path.
  if (path !== undefined && found.path !== undefined && found.path !== path && existsSync(found.path)) {
    throw invalid(`an entry for ${found.path}, which has the same name`, `an entry for ${path}`);
  }
  return poseIn(found.read(), name, invalid);
}

function poseIn(entry: unknown, name: string, invalid: Invalid): object {
  if (isRecord(entry) && "error" in entry) throw invalid(`the failure of ${name}`, "an aligned case");
  if (isRecord(entry) || Array.isArray(entry)) return entry;
  throw invalid("an object without it", `a transform, or an entry for ${name}`);
}

/** The poses of the frames in an entry, by their names: of several views, or of a video. */
function framesOf(entry: object): Readonly<Record<string, unknown>> | undefined {
  const { frames, views } = entry as Readonly<Record<string, unknown>>;
  if (!Array.isArray(views)) return isRecord(frames) ? frames : undefined;
  return Object.fromEntries(views.map((view) => [String(view?.name), view]));
}
