/** Transforms from files: of one pose, and of the results of a batch. */
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { isPose, parsePoseFile, poseJson } from "../conventions/pose-file.js";
import { read } from "../read-files.js";
import { failure, Sim3AlignError } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { oncePerKey } from "../values/validation.js";
import { realPath } from "./files.js";
import type { CaseKey } from "./record.js";

const remedy = 'See "sim3align evaluate --help" for the layout of a transform file.';

/** The entry of a case in the results of a batch. */
interface BatchEntry {
  name: string;
  /** The absolute path of the case. */
  path: string | undefined;
  entry: unknown;
}

/** The content of a transform file: a pose, or the entries of a batch. */
type TransformFile = { pose: object } | { entries: readonly BatchEntry[] };

/** Each file is read once, for all cases: --json may overwrite it when the first one is done. */
const contentOf = oncePerKey(async (path: string, argument: string) =>
  parse(new TextDecoder().decode(await read(argument, path)), argument, path),
);

/**
 * Reads a transform file as 16 numbers, column-major.
 * @param argument the name of the transform in errors
 * @param key the case, whose entry is read from the output of `align --json` or from a record: that of its path, or of its name
 * if the file has no path for it
 * @param frame its frame, whose pose is read from that entry
 */
export async function readTransform(
  argument: "transform" | "initial",
  path: string,
  key: Pick<CaseKey, "name" | "path">,
  frame?: string,
): Promise<number[]> {
  const invalid = (found: string, expected: string) => failure("INVALID_TRANSFORM", argument, found, expected, remedy);
  const content = await contentOf(path, argument);
  const own = "pose" in content ? content.pose : entryOf(content.entries, key, invalid);
  const frames = frame === undefined ? undefined : framesOf(own);
  const entry = frame === undefined || frames === undefined ? own : poseIn(frames[frame], frame, invalid);
  const pose = parsePoseFile(argument, entry);
  if (pose === null) throw invalid("a file without a known pose", "a transform");
  return Array.from(pose.transform.matrix);
}

function parse(text: string, argument: string, path: string): TransformFile {
  try {
    const folder = realPath(dirname(path));
    const absolute = (relative: unknown) => (typeof relative === "string" ? join(folder, relative) : undefined);
    if (/^\{"(?:case|sim3align)":/.test(text)) {
      const lines = text.split("\n").filter((line) => line.trim() !== "" && !/^\{"sim3align":/.test(line));
      const rows = lines.map((line) => JSON.parse(line) as { case: string; path?: unknown });
      // Of a case that a record has twice, the last line counts.
      return {
        entries: rows.reverse().map(({ case: name, path, ...entry }) => ({ name, path: absolute(path), entry })),
      };
    }
    const json = poseJson(argument, text);
    // Cases may have the names of the parts of a pose, too.
    if (Array.isArray(json) || (isRecord(json) && isPose(json))) return { pose: json };
    if (!isRecord(json)) throw new Error(`${JSON.stringify(json)} is no transform`);
    const entries = Object.entries(json).map(([name, entry]) => {
      return { name, path: isRecord(entry) ? absolute(entry.path) : undefined, entry };
    });
    return { entries };
  } catch (cause) {
    if (cause instanceof Sim3AlignError) throw cause;
    throw failure("CORRUPT_FILE", argument, `${path}: ${(cause as Error).message}`, "JSON", remedy, cause);
  }
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
  return poseIn(found.entry, name, invalid);
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
