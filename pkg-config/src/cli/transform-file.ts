/** Transforms from JSON files. */

import { isPose, parsePoseFile, poseJson } from "../conventions/pose-file.js";
import { read } from "../read-files.js";
import { failure } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { oncePerKey } from "../values/validation.js";

const remedy = 'See "sim3align evaluate --help" for the layout of a transform file.';

/** Each file is read once, for all cases: --json may overwrite it when the first one is done. */
const jsonIn = oncePerKey(async (path: string, argument: string) =>
  parse(new TextDecoder().decode(await read(argument, path)), argument, path),
);

/**
 * Reads a transform file as 16 numbers, column-major.
 * @param argument the name of the transform in errors
 * @param name the case, whose entry is read from the output of `align --json` or from a record
 * @param frame its frame, whose pose is read from that entry
 */
export async function readTransform(
  argument: "transform" | "initial",
  path: string,
  name: string,
  frame?: string,
): Promise<number[]> {
  const json = await jsonIn(path, argument);
  const invalid = (found: string, expected: string) => failure("INVALID_TRANSFORM", argument, found, expected, remedy);
  const own = entryOf(json, name, invalid);
  const frames = frame === undefined ? undefined : framesOf(own);
  const entry = frame === undefined || frames === undefined ? own : entryOf(frames, frame, invalid);
  const pose = parsePoseFile(argument, entry);
  if (pose === null) throw invalid("a file without a known pose", "a transform");
  return Array.from(pose.transform.matrix);
}

/** A JSON file, or the entries of a record by case. */
function parse(text: string, argument: string, path: string): unknown {
  try {
    if (!/^\{"(?:case|sim3align)":/.test(text)) return poseJson(argument, text);
    const lines = text.split("\n").filter((line) => line.trim() !== "" && !/^\{"sim3align":/.test(line));
    // Of a case that a record has twice, the first line counts, as for --resume.
    return Object.fromEntries(
      lines.reverse().map((line) => {
        const { case: name, ...entry } = JSON.parse(line) as { case: string };
        return [name, entry];
      }),
    );
  } catch (cause) {
    throw failure("CORRUPT_FILE", argument, `${path}: ${(cause as Error).message}`, "JSON", remedy, cause);
  }
}

function entryOf(json: unknown, name: string, invalid: (found: string, expected: string) => Error): object {
  if (Array.isArray(json)) return json;
  if (!isRecord(json)) throw invalid(JSON.stringify(json), "an object");
  if (isPose(json)) return json;
  const entry = json[name];
  if (Array.isArray(entry)) return entry;
  if (isRecord(entry) && !("error" in entry)) return entry;
  if (isRecord(entry)) throw invalid(`the failure of ${name}`, "an aligned case");
  throw invalid(
    `an object with ${Object.keys(json).slice(0, 12).join(", ") || "nothing"}`,
    `a transform, or an entry for ${name}`,
  );
}

/** The poses of the frames in an entry, by their names: of several views, or of a video. */
function framesOf(entry: object): object | undefined {
  const { frames, views } = entry as Readonly<Record<string, unknown>>;
  if (!Array.isArray(views)) return isRecord(frames) ? frames : undefined;
  return Object.fromEntries(views.map((view) => [String(view?.name), view]));
}
