/** `sim3align align`: reads cases, aligns them, and prints the results. */
import { basename, extname, join } from "node:path";
import { type CaseOnDisk, type ReadCaseOptions, readCaseFiles, readCaseFolder } from "../case-folder.js";
import { partOf } from "../case-names.js";
import { type KnownPose, parsePoseFile } from "../conventions/pose-file.js";
import type { Frame, Frames } from "../frames.js";
import { frameNames, inputOfFrame, openFrames } from "../frames-folder.js";
import {
  type Aligner,
  type AlignInput,
  OPTIONS,
  type OptionRow,
  type PoseErrors,
  type Preset,
  type Sim3,
  type ViewsOptions,
} from "../index.js";
import { extensionsOf } from "../input/formats.js";
import type { OptionsOf } from "../types/options.js";
import type { InputInfo } from "../types/results.js";
import { withoutUndefined } from "../values/validation.js";
import { type CaseRun, failedLines, type Job } from "./batch.js";
import { alignDetails, viewsDetails, warningLine, withMeans } from "./details.js";
import {
  type AlignEntry,
  alignEntry,
  type Entry,
  isFailure,
  isMetric,
  type ViewsEntry,
  viewsEntry,
  warningsOf,
  withFiles,
} from "./entry.js";
import { correctedInput } from "./exports.js";
import { absolutePath, namesIn, statOf, textOf, UsageError } from "./files.js";
import { caseSettings, type Flags } from "./flags.js";
import { caseKind, foldersToDo } from "./folders.js";
import { optionValues } from "./option-flags.js";
import type { CaseKey } from "./record.js";
import { caseTable } from "./table.js";
import type { Style } from "./terminal.js";
import { readTransform } from "./transform-file.js";

/** The options of both presets, and those of one. */
export const shared = OPTIONS.align.filter(({ name }) => OPTIONS.paper.some((row) => row.name === name));
const isShared = ({ name }: OptionRow) => shared.some((row) => row.name === name);
export const precise: readonly OptionRow[] = OPTIONS.align.filter((row) => !isShared(row));
export const paper: readonly OptionRow[] = OPTIONS.paper.filter((row) => !isShared(row));

/** A case to read and align. */
export interface CaseToDo extends CaseKey {
  /** Whether it has a true pose. */
  readonly hasTruth: boolean;
  /** Reads a case of one view. */
  read(): Promise<CaseView>;
}

/** The job of a command line. */
export async function alignJob(args: readonly string[], flags: Flags): Promise<Job<CaseToDo>> {
  const settings = caseSettings(flags);
  const only = caseOfFiles(flags, args, settings);
  if (only !== undefined) return caseJob([only], flags);
  const folders = await foldersToDo(caseKind, args, flags.list);
  return caseJob(
    folders.map((each) => ({
      ...each,
      // Read when it is asked for: among thousands of cases, the first ones tell.
      get hasTruth() {
        return hasTruth(each.folder);
      },
      read: () => readCaseFolder(each.folder, settings),
    })),
    flags,
  );
}

/** The case of the files that the flags name; `undefined` if they name none. A photo is one of the arguments, too. */
function caseOfFiles(flags: Flags, args: readonly string[], settings: ReadCaseOptions): CaseToDo | undefined {
  const { depth, mask, mesh, camera, image: photo } = flags;
  const hasList = flags.list !== undefined;
  const photos = args.filter(isPhoto);
  if ([depth, mask, mesh, camera].every((flag) => flag === undefined)) {
    if (typeof photo === "string")
      throw new UsageError("--image belongs to --depth, --mask and --mesh; a case folder holds its own.");
    if (photos.length > 0 && photos.length === args.length && !hasList)
      throw new UsageError(`${photos[0]} is a photo: pass its --depth, --mask and --mesh with it.`);
    if (args.length === 0 && !hasList)
      throw new UsageError("Pass at least one case folder, or --depth, --mask and --mesh.");
    return undefined;
  }
  if (hasList || photos.length < args.length)
    throw new UsageError("Pass case folders, or --depth, --mask and --mesh, but not both.");
  const named = typeof photo === "string" ? [photo, ...photos] : photos;
  if (named.length > 1) throw new UsageError(`Pass one photo, not ${named.join(" and ")}.`);
  if (depth === undefined || mask === undefined || mesh === undefined)
    throw new UsageError("--depth, --mask and --mesh belong together: pass all three.");
  const name = basename(mesh).replace(/\.[^.]*$/, "");
  const read = () => readCaseFiles(name, { depth, mask, mesh, camera, image: named[0] }, settings);
  // Of the files, the mask is that of one object in one image.
  const files = [depth, mask, mesh, ...(typeof camera === "string" ? [camera] : []), ...named].map(absolutePath);
  return { name, path: absolutePath(mask), files, hasTruth: false, read };
}

/** Whether an argument names a photo; folders may be named like one. */
const isPhoto = (path: string) =>
  extensionsOf("photo").includes(extname(path).slice(1).toLowerCase()) && !statOf(path)?.isDirectory();

function hasTruth(folder: string): boolean {
  const name = namesIn(folder).find((name) => partOf(name) === "truth");
  try {
    return name !== undefined && parsePoseFile("truth", textOf("gt.json", join(folder, name))) !== null;
  } catch {
    // A file that cannot be read is reported for its case.
    return false;
  }
}

const metrics = ["iou", "boundaryF", "centerDriftPx", "chamferM", "fitness", "depthMaeM"] as const;
const errors = ["scaleError", "rotationErrorDeg", "translationErrorM", "translationErrorRelative"] as const;

/** The columns of several evaluations. */
export const evaluationColumns = [...metrics, ...errors];

/** The job for a list of cases. */
export function caseJob(tasks: readonly CaseToDo[], flags: Flags): Job<CaseToDo> {
  const row = caseTable(
    tasks.map(({ name }) => name),
    [
      ...(["confidence", "alternatives", "scale", "scaleRatio"] as const),
      ...metrics,
      "timeMs",
      // The errors have columns if a case has a true pose.
      ...(tasks.some((each) => each.hasTruth) ? errors : []),
    ],
  );
  return {
    tasks,
    folders: tasks.flatMap(({ folder }) => folder ?? []),
    run: (aligner, task, caseRun) => alignCase(aligner, task, flags, caseRun),
    lines: ({ name }, entry, isOnly, style) =>
      isOnly
        ? { remarks: isFailure(entry) ? failedLines(name, entry, style) : details(name, entry, style) }
        : { rows: row(name, withMeans(entry), style), remarks: notes(name, entry, style) },
    async inputs({ name, folder, read }) {
      const views = folder === undefined ? [await read()] : await viewsOf(folder, caseSettings(flags));
      return new Map(views.map((view) => ["frame" in view ? `${name}/${view.frame}` : name, view.input]));
    },
  };
}

const details = (name: string, entry: Entry, style: Style) =>
  "views" in entry
    ? viewsDetails(name, entry as unknown as ViewsEntry, style)
    : alignDetails(name, entry as unknown as AlignEntry, style);

/** The failure or the warnings of one of several cases. */
const notes = (name: string, entry: Entry, style: Style) =>
  isFailure(entry)
    ? failedLines(name, entry, style)
    : warningsOf(entry).map((warning) => `${name}: ${warningLine(warning, style)}`);

/** A view of the object of a case: the case itself, or one of its frames. */
export interface CaseView extends Pick<CaseOnDisk, "input" | "truth">, Partial<Pick<CaseOnDisk, "found">> {
  frame?: string;
}

/** The view of a case, or those of its frames with a mask. */
export async function viewsOf(folder: string, settings: ReadCaseOptions): Promise<CaseView[]> {
  if ((await frameNames(folder)).length === 0) return [await readCaseFolder(folder, settings)];
  const opened = await openFrames(folder, settings);
  return maskedViews(opened, (await framesOf(opened)).frames);
}

/** The views of frames with a mask. */
export const maskedViews = ({ mesh }: Frames, frames: readonly Frame[]): CaseView[] =>
  frames.flatMap(({ name, ...frame }) => {
    const input = inputOfFrame(frame, mesh);
    return input === undefined ? [] : [{ ...frame, frame: name, input }];
  });

async function alignCase(aligner: Aligner, task: CaseToDo, flags: Flags, caseRun: CaseRun): Promise<Entry> {
  const { folder } = task;
  if (folder === undefined || (await frameNames(folder)).length === 0) {
    return alignView(aligner, task, await task.read(), flags, caseRun);
  }
  const opened = await openFrames(folder, caseSettings(flags));
  const view = isOneView(opened) ? await onlyView(folder, opened) : undefined;
  if (view === undefined) return alignFrames(aligner, task, opened, flags, caseRun);
  return alignView(aligner, task, view, flags, caseRun);
}

/** The view of frames of which one is to be aligned; `undefined` for several, and without a mask. */
export async function onlyView(folder: string, opened: Frames): Promise<CaseView | undefined> {
  const [only, ...others] = opened.views;
  if (only === undefined || others.length > 0) return undefined;
  const { truth, ...frame } = await opened.read(only);
  const input = inputOfFrame(frame, opened.mesh);
  const { files, unread } = opened.found();
  return input && { input, truth, found: { folder, files: { ...frame.found.files, ...files }, unread } };
}

async function alignView(
  aligner: Aligner,
  task: CaseToDo,
  { input, truth, found }: CaseView,
  flags: Flags,
  caseRun: CaseRun,
): Promise<Entry> {
  caseRun.found = found;
  const options = await alignOptions(flags, task, input.mesh);
  const settings = withoutUndefined({ ...options, onProgress: caseRun.onProgress });
  const alignment = await aligner.align<Preset, boolean>(input, settings);
  return withFiles(alignEntry(alignment, await errorsOf(aligner, input, alignment, truth)), found);
}

/** Whether one view is aligned, as the only frame of several that has a mask. */
export const isOneView = ({ views, names }: Frames) => views.length === 1 && names.length > 1;

/** The views of a case. Without the camera poses of all frames, those of some do not help. */
export async function framesOf({ views: names, read }: Frames) {
  const frames = await Promise.all(names.map(read));
  const isKnown = frames.every(({ input }) => input.cameraToWorld !== undefined);
  return { frames, views: frames.map(({ input }) => (isKnown ? input : { ...input, cameraToWorld: undefined })) };
}

async function alignFrames(aligner: Aligner, task: CaseToDo, opened: Frames, flags: Flags, caseRun: CaseRun) {
  const { mesh, found } = opened;
  const { frames, views } = await framesOf(opened);
  caseRun.found = found();
  const { preset, ...options } = await alignOptions(flags, task, mesh);
  if (preset === "paper")
    throw new UsageError(`${task.name} has several frames, for which --preset paper has no method.`);
  const { onProgress } = caseRun;
  const alignment = await aligner.alignViews(
    { mesh, views },
    withoutUndefined({ ...(options as ViewsOptions), onProgress }),
  );
  const errors = frames.map(async (frame, k) => {
    const [pose, input] = [alignment.views[k], inputOfFrame(frame, mesh)];
    return pose === undefined || input === undefined ? null : errorsOf(aligner, input, pose, frame.truth);
  });
  return withFiles(viewsEntry(alignment, frames, await Promise.all(errors)), found());
}

/** The errors of a metric pose relative to the true one; `null` without a true pose. */
export async function errorsOf(
  aligner: Aligner,
  input: AlignInput,
  pose: Sim3 & InputInfo,
  truth: KnownPose | null | undefined,
): Promise<PoseErrors | null> {
  if (truth === null || truth === undefined || !isMetric(pose)) return null;
  const { transform, symmetry } = truth;
  const measured = await correctedInput(input, pose.depthCalibration);
  return (await aligner.evaluate(measured, pose, { truth: transform, symmetry })).errors;
}

/** The options set by `--options` and by flags. */
async function alignOptions(
  flags: Flags,
  key: Pick<CaseKey, "name" | "path">,
  mesh: unknown,
): Promise<OptionsOf<Preset, boolean>> {
  const options: Record<string, unknown> = {
    ...flags.options,
    ...optionValues(flags, [...shared, ...precise, ...paper]),
    ...withoutUndefined({ preset: flags.preset }),
  };
  if (typeof options.initial === "string") options.initial = await readTransform("initial", options.initial, key, mesh);
  return options as unknown as OptionsOf<Preset, boolean>;
}
