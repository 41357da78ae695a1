/** The JSON entry of a case: the model of a result for files, tables, pictures and reports. */

import { join } from "node:path";
import { isAssumed } from "../calls/notes.js";
import { listed } from "../case-files.js";
import type { FoundFiles, FrameOnDisk } from "../case-folder.js";
import type { AlignResult, PoseErrors, SceneResult, Sim3, TrackedFrame, ViewsAlignment } from "../index.js";
import type { Message, Row } from "../report-page/row.js";
import type { InputInfo } from "../types/results.js";
import { describe, failure, Sim3AlignError } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { withoutUndefined } from "../values/values.js";
import { UsageError } from "./files.js";
import { OutputError } from "./output-file.js";

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
  const objects = Object.entries((entry.objects ?? {}) as Record<string, InputInfo>);
  const facts: Record<string, object> = {
    depth: { unit, camera: source === "depth file" ? source : undefined },
    mask: { reading: maskReading },
    ...Object.fromEntries(objects.map(([name, own]) => [`objects/${name}/mask`, { reading: own.maskReading }])),
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
  const { frames, objects = frames } = entry;
  const all: [string, Entry][] = [["", entry], ...Object.entries((objects ?? {}) as Record<string, Entry>)];
  const unread = all.flatMap(([part, { unread }]) => ((unread ?? []) as string[]).map((name) => join(part, name)));
  const assumed = all.flatMap(([, { depthUnit, cameraSource }]) => [
    ...(isAssumed({ depthUnit } as InputInfo) ? [`depth unit ${String(depthUnit).replace(", assumed", "")}`] : []),
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

/** The transform and other properties of a pose. */
function poseEntry<T extends Sim3>({ scale, rotation, rotationMatrix, translation, matrix, ...rest }: T) {
  return { scale, rotation: rotationMatrix, translation, matrix, quaternion: rotation, ...rest };
}

const transformOf = ({ scale, rotation, rotationMatrix, translation, matrix }: Sim3): Sim3 => ({
  ...{ scale, rotation, rotationMatrix, translation, matrix },
});

/** The readings of the files. */
export const inputEntry = ({ depthUnit, cameraSource, maskReading, imageReading, depthCalibration }: InputInfo) =>
  withoutUndefined({ depthUnit, cameraSource, maskReading, imageReading, depthCalibration }) as InputInfo;

export type AlignEntry = ReturnType<typeof alignEntry>;

/**
 * The entry of an aligned case. Its properties do not depend on the preset.
 * @param errors relative to the true pose, if it is known
 */
export function alignEntry(alignment: Omit<AlignResult, "input">, errors: PoseErrors | null) {
  const { metrics, warnings } = alignment;
  const { timingsMs, ...diagnostics } = alignment.diagnostics;
  type Certain = Pick<
    AlignResult<"precise">,
    "confidence" | "turnConfidence" | "alternatives" | "uncertainty" | "proportions"
  >;
  const certain = alignment as Partial<Certain>;
  const { confidence = null, turnConfidence = null, alternatives = [], uncertainty = null, proportions } = certain;
  return {
    ...poseEntry(transformOf(alignment)),
    ...{ confidence, turnConfidence, alternatives: alternatives.map(poseEntry), uncertainty },
    ...(proportions === undefined ? {} : { proportions: poseEntry(proportions) }),
    ...(metrics === undefined ? {} : { metrics }),
    ...{ warnings, ...inputEntry(alignment), timingsMs, diagnostics },
    ...(errors === null ? {} : { errors }),
  };
}

export type ViewsEntry = ReturnType<typeof viewsEntry>;

/** The entry of several views: the pose in the world, if the camera poses are known, and that in each frame. */
export function viewsEntry(
  alignment: ViewsAlignment,
  frames: readonly Pick<FrameOnDisk, "name" | "found">[],
  errors: (PoseErrors | null)[],
) {
  const { scale, world, confidence, alternatives, uncertainty, proportions, warnings } = alignment;
  const { timingsMs, ...diagnostics } = alignment.diagnostics;
  const views = alignment.views.map(({ camera, ...view }, k) => {
    const rest = errors[k] ?? null;
    const entry = { ...poseEntry(view), camera: poseEntry(camera), ...(rest === null ? {} : { errors: rest }) };
    return withFiles(entry, frames[k]?.found);
  });
  return {
    // Without camera poses, there is no world: the poses are those of the frames.
    ...(world === "given" ? poseEntry(transformOf(alignment)) : { scale }),
    ...{ world, confidence, alternatives: alternatives.map(poseEntry), uncertainty },
    ...(proportions === undefined ? {} : { proportions: poseEntry(proportions) }),
    ...{ frames: Object.fromEntries(frames.map(({ name }, k) => [name, views[k] as (typeof views)[number]])) },
    ...{ warnings, timingsMs, diagnostics },
  };
}

/** The entry of a frame of a video. */
export const frameEntry = (tracked: TrackedFrame) => poseEntry(tracked);

/** The entry of a video, with the frames so far. */
export function trackEntry(frames: ReadonlyMap<string, Entry>, found: FoundFiles) {
  const poses = [...frames.values()].filter((entry) => !isFailure(entry));
  return withFiles({ scale: poses.at(-1)?.scale ?? null, frames: Object.fromEntries(frames) }, found);
}

export type SceneEntry = ReturnType<typeof sceneEntry>;

/** The entry of a scene. */
export function sceneEntry(result: SceneResult, errors: readonly (PoseErrors | null)[]) {
  const { support, metrics, warnings } = result;
  const objects = result.objects.map((object, i) => {
    const entry =
      object.error === undefined
        ? { ...alignEntry(object, errors[i] ?? null), contact: object.contact }
        : failureEntry(object.error);
    return [object.name ?? `${i}`, entry] as const;
  });
  return { objects: Object.fromEntries(objects), support, metrics, warnings, ...inputEntry(result) };
}

/** The poses in an entry: those of its frames or objects, otherwise the entry itself. */
export function posesIn(name: string, entry: Entry): { name: string; entry: Entry }[] {
  const { frames, objects = frames, ...rest } = entry;
  if (!isRecord(objects)) return [{ name, entry: rest }];
  // The objects of a scene are in one depth map.
  const { depthCalibration, support } = rest;
  return Object.entries(objects).map(([part, pose]) => ({
    name: `${name}/${part}`,
    entry: { ...withoutUndefined({ depthCalibration, support }), ...(pose as Entry) },
  }));
}

/** The codes of the errors of an entry, or of its frames or objects. */
export const errorsIn = (entry: Entry): string[] =>
  isFailure(entry)
    ? [entry.error.code]
    : posesIn("", entry).flatMap((part) => (isFailure(part.entry) ? [part.entry.error.code] : []));

/** The alternatives of an entry. */
export const alternativesOf = ({ alternatives }: Entry): Entry[] =>
  Array.isArray(alternatives) ? alternatives.filter(isRecord) : [];

/** Whether the lengths of a result, or of its entry, are metres. */
export function isMetric(result: object): boolean {
  const { depthCalibration, frames, views = frames, ...rest } = result as Entry;
  if (isRecord(depthCalibration)) return depthCalibration.isMetric !== false;
  if (typeof views === "object" && views !== null) return Object.values(views).every(isMetric);
  return rest.isMetric !== false;
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
  ...["qx", "qy", "qz", "qw"].map((name, i) => [name, at("quaternion", i)] as const),
  ...["txM", "tyM", "tzM"].map((name, i) => [name, at("translation", i)] as const),
  ...within("diagnostics", "initialScale", "scaleRatio"),
  ...within("metrics", "iou", "boundaryF", "centerDriftPx", "chamferMm", "uniChamferMm", "fitness"),
  ...within("metrics", "normalConsistency", "depthMaeMm"),
  ...within("errors", "scaleError", "rotationErrorDeg", "translationErrorM", "translationErrorRelative", "addSMm"),
  [
    "warnings",
    (entry) =>
      "warnings" in entry
        ? warningsOf(entry)
            .map(({ code }) => code)
            .join(" ")
        : undefined,
  ],
  ["timeMs", at("timingsMs", "total")],
];

/** The row of an entry in a table. */
export function rowOf(entry: Entry): Row {
  const { error, ...numbers } = Object.fromEntries(rowFields.map(([name, read]) => [name, read(entry)]));
  const failed = isFailure(entry) ? { error: messageOf(entry.error as Entry) } : {};
  return { ...numbers, ...failed, warnings: warningsOf(entry), isMetric: isMetric(entry) };
}
