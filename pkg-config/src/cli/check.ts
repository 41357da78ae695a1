/** `sim3align check`: reads cases without aligning them, and names what would fail or be doubted. */

import { isRaw } from "../calls/calibrate.js";
import { withNotes } from "../calls/notes.js";
import type { ReadCaseOptions } from "../case-folder.js";
import { frameNames, openFrames } from "../frames-folder.js";
import type { Aligner } from "../index.js";
import { resolveInput } from "../input/resolve.js";
import { fileReaders } from "../modules/readers.js";
import { type CaseView, framesOf, isOneView, maskedViews, viewsOf } from "./align.js";
import { failedLines, type Job } from "./batch.js";
import { warningLine } from "./details.js";
import { type Entry, failureEntry, isFailure, posesIn, warningsOf, withFiles } from "./entry.js";
import { caseSettings, type Flags } from "./flags.js";
import { caseKind, type FolderToDo, foldersToDo } from "./folders.js";
import type { Style } from "./terminal.js";

/** The job of a command line. */
export async function checkJob(args: readonly string[], flags: Flags): Promise<Job<FolderToDo>> {
  const tasks = await foldersToDo(caseKind, args, flags.list);
  return {
    tasks,
    folders: tasks.map(({ folder }) => folder),
    async run(aligner, { folder }) {
      const frames = new Map<string, Entry>();
      for (const view of await readViews(aligner, folder, caseSettings(flags))) {
        const entry = await checked(aligner, view).catch((error) => failureEntry(error, view.found));
        if (view.frame === undefined) return entry;
        frames.set(view.frame, entry);
      }
      return { frames: Object.fromEntries(frames) };
    },
    lines: ({ name }, entry, _, style) => ({
      rows: posesIn(name, entry).flatMap((view) => linesOf(view.name, view.entry, style)),
    }),
  };
}

/** The views of a case. If masks are missing, they fail as they would be aligned: this fails before any work. */
async function readViews(aligner: Aligner, folder: string, settings: ReadCaseOptions): Promise<CaseView[]> {
  if ((await frameNames(folder)).length === 0) return viewsOf(folder, settings);
  const opened = await openFrames(folder, settings);
  const { frames, views } = await framesOf(opened);
  const isMasked = ({ mask }: (typeof views)[number]) => mask !== undefined;
  const isEnough = views.every((view) => isMasked(view) || view.cameraToWorld !== undefined) && views.some(isMasked);
  if (!isOneView(opened) && !isEnough) await aligner.alignViews({ mesh: opened.mesh, views });
  return maskedViews(opened, frames);
}

/** Any pose: nothing that is read depends on it. */
const ANYWHERE = {
  scale: 1,
  rotation: [0, 0, 0, 1] as [number, number, number, number],
  translation: [0, 0, 1] as [number, number, number],
};

async function checked(aligner: Aligner, { input, found }: CaseView): Promise<Entry> {
  const { core, notes } = await resolveInput(input, fileReaders);
  // Depth or a lens that an alignment has to calibrate first cannot be measured.
  const { warnings } = isRaw(core) ? withNotes({ warnings: [] }, notes) : await aligner.evaluate(input, ANYWHERE);
  const { depthUnit, cameraSource, maskReading, imageReading } = notes;
  return withFiles({ warnings, depthUnit, cameraSource, maskReading, imageReading }, found);
}

function linesOf(name: string, entry: Entry, style: Style): string[] {
  if (isFailure(entry)) return failedLines(name, entry, style);
  const doubts = warningsOf(entry).map((warning) => `${name}: ${warningLine(warning, style)}`);
  return doubts.length > 0 ? doubts : [`${name}: can be aligned`];
}
