/** The JSON entry of a case: the model of a result for files, tables, pictures and reports. */

import { join } from "node:path";
import { listed } from "../case-files.js";
import type { FoundFiles } from "../case-folder.js";
import type { Frame } from "../frames.js";
import type { AlignResult, PoseErrors, SceneResult, ViewsAlignment } from "../index.js";
import { unitText } from "../input/depth-kinds.js";
import type { InputInfo } from "../types/results.js";
import { describe, failure, Sim3AlignError } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { withoutUndefined } from "../values/validation.js";
import { UsageError } from "./files.js";
import { OutputError } from "./output-file.js";
import type { Message, Row } from "./row.js";

/** An entry of any kind. */
export type Entry = Readonly<Record<string, unknown>>;

/** The entry of a failure. `file` is the invalid file, if known. */
export interface FailureEntry extends Entry {
  error: Pick<Sim3AlignError, "code" | "argument" | "found" | "expected" | "remedy" | "message"> & { file?: string };
}

/**
 * The entry of a failure.
 * @param found the files that were found before
 * @throws {@link UsageError}, {@link OutputError} for errors that concern all cases
 */
export function failureEntry(thrown: unknown, found?: FoundFiles): FailureEntry {
  if (thrown instanceof UsageError || thrown instanceof OutputError) throw thrown;
  const { code, argument, found: what, expected, remedy, message } = asSim3AlignError(thrown);
  // All cases would fail with this error, but for that of an initial pose, which may differ from case to case.
  if (argument.startsWith("options") && !argument.startsWith("options.initial")) throw new UsageError(message);
  const part = argument.split(".")[0] ?? "";
  const file = found?.files[part === "cameraFile" ? "camera" : part];
  const path = found === undefined || file === undefined ? {} : { file: join(found.folder, file) };
  return withFiles({ error: { code, argument, found: what, expected, remedy, message, ...path } }, found);
}

/** An entry with the files of its folder: what each was read as, and how; and those that were not read. */
export function withFiles<T extends Entry>(entry: T, found: FoundFiles | undefined): T {
  if (found === undefined) return entry;
  const { depthUnit: unit, maskReading, imageReading, cameraSource: source = "" } = entry as InputInfo;
  const facts: Record<string, object> = {
    depth: { unit, camera: source === "depth file" ? source : undefined },
    mask: { reading: maskReading },
    ...Object.fromEntries(
      (partsOf(entry) ?? []).map(([name, own]) => [`objects/${name}/mask`, { reading: own.maskReading }]),
    ),
    image: { reading: imageReading, camera: source.startsWith("EXIF") ? source : undefined },
  };
  const inputs: Record<string, object> = {};
  for (const [path, name] of Object.entries(found.files)) {
    const part = path.slice(path.lastIndexOf("/") + 1);
    inputs[name] ??= withoutUndefined({ as: part, ...(facts[path] ?? facts[part]) });
  }
  return { ...entry, inputs, unread: found.unread };
}

/** Remarks on the inputs of a case, a line each: unread files, assumptions, and lengths without a unit. */
export function intakeLines(entry: Entry): string[] {
  const all: [string, Entry][] = [["", entry], ...(partsOf(entry) ?? [])];
  const unread = all.flatMap(([part, { unread }]) => ((unread ?? []) as string[]).map((name) => join(part, name)));
  const assumed = (all as [string, InputInfo][]).flatMap(([, { depthUnit, cameraSource }]) => [
    ...(depthUnit?.isAssumed ? [`depth unit ${unitText({ ...depthUnit, isAssumed: false })}`] : []),
    ...(cameraSource === "estimate" ? ["focal length"] : []),
  ]);
  return [
    ...(unread.length === 0 ? [] : [`not read: ${listed(unread)}`]),
    ...(assumed.length === 0 ? [] : [`assumed: ${[...new Set(assumed)].join("; ")}`]),
    ...(isMetric(entry) ? [] : ["Lengths have no unit: --known-extent, or a number as --scale, makes them metric."]),
  ];
}

function asSim3AlignError(error: unknown): Sim3AlignError {
  if (error instanceof Sim3AlignError) return error;
  const found = error instanceof Error ? (error.stack ?? error.message) : describe(error);
  const remedy = "This is a bug in sim3align. Please report it with the input.";
  return failure("INTERNAL", "sim3align", found, "a result or a Sim3AlignError", remedy, error);
}

export const isFailure = (entry: Entry): entry is FailureEntry => isRecord(entry.error);

/** The errors relative to the true pose, if it is known. */
const withErrors = (errors: PoseErrors | null | undefined): { errors?: PoseErrors } =>
  errors === null || errors === undefined ? {} : { errors };

export type AlignEntry = ReturnType<typeof alignEntry>;

/** The entry of an aligned case: the result, and its errors. */
export const alignEntry = (alignment: AlignResult, errors: PoseErrors | null) => ({
  ...alignment,
  ...withErrors(errors),
});

export type ViewsEntry = ReturnType<typeof viewsEntry>;

/** The entry of several views: the result, with the names, errors and files of the frames. */
export const viewsEntry = (
  alignment: ViewsAlignment,
  frames: readonly Pick<Frame, "name" | "found">[],
  errors: readonly (PoseErrors | null)[],
) => ({
  ...alignment,
  views: alignment.views.map((view, k) => {
    const { name = `${k}`, found } = frames[k] ?? {};
    return withFiles({ name, ...view, ...withErrors(errors[k]) }, found);
  }),
});

export type SceneEntry = ReturnType<typeof sceneEntry>;

/** The entry of a scene: the result, with the errors of the objects. */
export const sceneEntry = (result: SceneResult, errors: readonly (PoseErrors | null)[]) => ({
  ...result,
  objects: result.objects.map((object, i) =>
    object.error === undefined ? { ...object, ...withErrors(errors[i]) } : { ...object, ...failureEntry(object.error) },
  ),
});

/**
 * The parts of an entry by their names: the frames of calls that take one each, the views of a case, or the objects of a scene.
 */
function partsOf({ frames, views, objects }: Entry): [name: string, entry: Entry][] | undefined {
  if (isRecord(frames)) return Object.entries(frames) as [string, Entry][];
  const parts = views ?? objects;
  return Array.isArray(parts) ? parts.map((part: Entry, k) => [String(part.name ?? k), part]) : undefined;
}

/** The poses in an entry: those of its parts, otherwise the entry itself. */
export function posesIn(name: string, entry: Entry): { name: string; entry: Entry }[] {
  const parts = partsOf(entry);
  if (parts === undefined) return [{ name, entry }];
  // The objects of a scene are in one depth map.
  const { depthUnit, depthCalibration, support } = entry;
  const whole = withoutUndefined({ depthUnit, depthCalibration, support });
  return parts.map(([part, pose]) => ({ name: `${name}/${part}`, entry: { ...whole, ...pose } }));
}

/** The codes of the errors of an entry, or of its frames or objects. */
export const errorsIn = (entry: Entry): string[] =>
  isFailure(entry)
    ? [entry.error.code]
    : posesIn("", entry).flatMap((part) => (isFailure(part.entry) ? [part.entry.error.code] : []));

/** Whether the lengths of a result, or of its entry, are metres. */
export function isMetric(result: object): boolean {
  const { depthCalibration, depthUnit, frames, views = frames } = result as InputInfo & Entry;
  if (depthCalibration !== undefined) return depthCalibration.isMetric;
  if (typeof views === "object" && views !== null) return Object.values(views).every(isMetric);
  return depthUnit?.metres !== null;
}

/** Follows property names and indices into a JSON value. */
const at =
  (...path: (string | number)[]) =>
  (entry: Entry): unknown =>
    path.reduce<unknown>((value, key) => (value as Record<string | number, unknown> | undefined | null)?.[key], entry);

const within = (group: string, ...names: string[]) => names.map((name) => [name, at(group, name)] as const);

const messageOf = ({ code, message }: Entry): Message => ({ code: String(code), message: String(message) });

/** The warnings of an entry. */
export const warningsOf = ({ warnings }: Entry): Message[] =>
  Array.isArray(warnings) ? warnings.filter(isRecord).map(messageOf) : [];

/** The fields of a row, in the order of CSV files. They do not depend on the results. */
export const rowFields: readonly (readonly [name: string, read: (entry: Entry) => unknown])[] = [
  ["error", at("error", "code")],
  ["confidence", at("confidence")],
  ["alternatives", ({ alternatives }) => (Array.isArray(alternatives) ? alternatives.length : undefined)],
  ["isMetric", (entry) => ("error" in entry ? undefined : isMetric(entry))],
  ["scale", at("scale")],
  ...["qx", "qy", "qz", "qw"].map((name, i) => [name, at("rotation", i)] as const),
  ...["txM", "tyM", "tzM"].map((name, i) => [name, at("translation", i)] as const),
  ...within("diagnostics", "initialScale", "scaleRatio"),
  ...within("metrics", "iou", "boundaryF", "centerDriftPx", "chamferM", "uniChamferM", "fitness"),
  ...within("metrics", "normalConsistency", "depthMaeM"),
  ...within("errors", "scaleError", "rotationErrorDeg", "translationErrorM", "translationErrorRelative", "addSM"),
  [
    "warnings",
    (entry) =>
      "warnings" in entry
        ? warningsOf(entry)
            .map(({ code }) => code)
            .join(" ")
        : undefined,
  ],
  ["timeMs", at("diagnostics", "timingsMs", "total")],
];

/** The row of an entry in a table. */
export function rowOf(entry: Entry): Row {
  const { error, ...numbers } = Object.fromEntries(rowFields.map(([name, read]) => [name, read(entry)]));
  const failed = isFailure(entry) ? { error: messageOf(entry.error as Entry) } : {};
  return { ...numbers, ...failed, warnings: warningsOf(entry), isMetric: isMetric(entry) };
}
