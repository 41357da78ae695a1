/** `sim3align track`: tracks an object through the frames of videos. */
import type { FoundFiles } from "../case-folder.js";
import { frameNames, openFrames } from "../frames-folder.js";
import { type Aligner, OPTIONS, type TrackedFrame, type TrackOptions } from "../index.js";
import type { CaseRun, Job } from "./batch.js";
import { depthRows } from "./details.js";
import { type Entry, failureEntry, withFiles } from "./entry.js";
import { UsageError } from "./files.js";
import { caseSettings, type Flags } from "./flags.js";
import { type FolderToDo, foldersToDo, videoKind } from "./folders.js";
import { optionValues } from "./option-flags.js";
import { fixed, significant } from "./row.js";
import { headings, numeric, pairs, tableLine } from "./table.js";
import { readTransform } from "./transform-file.js";

const columns = [
  { heading: "frame", width: 24 },
  { heading: "state", width: 10 },
  ...["conf.", "scale", "± %", "time ms"].map((heading) => numeric(heading, 9)),
];

/** The job of a command line. */
export async function trackJob(args: readonly string[], flags: Flags): Promise<Job<FolderToDo>> {
  const tasks = await foldersToDo(videoKind, args, flags.list);
  for (const { folder } of tasks) {
    if ((await frameNames(folder)).length === 0)
      throw new UsageError(`${folder} has no folder frame_*, and no depth/ with a file per frame.`);
  }
  const folders = tasks.map(({ folder }) => folder);
  return { tasks, folders, run: (aligner, video, caseRun) => trackVideo(aligner, video, flags, caseRun) };
}

async function trackVideo(
  aligner: Aligner,
  { name, path, folder }: FolderToDo,
  flags: Flags,
  caseRun: CaseRun,
): Promise<Entry> {
  const { mesh, names, read, found } = await openFrames(folder, caseSettings(flags));
  const options = optionValues(flags, OPTIONS.track);
  if (typeof options.initial === "string")
    options.initial = await readTransform("initial", options.initial, { name, path }, mesh);
  caseRun.found = found();
  const tracker = await aligner.track(mesh, options as TrackOptions);
  try {
    caseRun.print(caseRun.style.bold(name), headings(columns));
    const frames = new Map<string, Entry>();
    const entry = () => withFiles({ frames: Object.fromEntries(frames) }, found());
    // How the last frame was read stands for the others.
    let last: TrackedFrame | undefined;
    let next: ReturnType<typeof read> | undefined;
    for (const [k, frame] of names.entries()) {
      const began = performance.now();
      let own: FoundFiles | undefined;
      let cells: string[];
      try {
        const reading = next ?? read(frame);
        next = undefined;
        const view = await reading;
        own = view.found;
        const { cameraToWorld: _, ...input } = view.input;
        const tracking = tracker.next(input);
        const following = names[k + 1];
        if (following !== undefined) {
          // The files of the next frame are read while the object is tracked in this one. What fails, fails in its turn.
          next = read(following);
          next.catch(() => {});
        }
        last = await tracking;
        const { state, confidence, scale, scaleSd } = last;
        frames.set(frame, withFiles({ ...last }, own));
        cells = [state, fixed(confidence, 2), significant(scale, 5), fixed(100 * scaleSd, 2)];
      } catch (error) {
        const failed = failureEntry(error, own);
        frames.set(frame, failed);
        cells = [failed.error.code, "–", "–", "–"];
      }
      caseRun.partial(entry());
      caseRun.print(tableLine(columns, [frame, ...cells, fixed(performance.now() - began, 0)]));
      if (caseRun.isClosed()) break;
    }
    if (last !== undefined) caseRun.print(...pairs(depthRows(last)));
    return entry();
  } finally {
    tracker.dispose();
  }
}
