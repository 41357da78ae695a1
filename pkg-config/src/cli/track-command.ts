/** `sim3align track`: tracks an object through videos and prints the results. */
import { join } from "node:path";
import { Command } from "commander";
import { frameNames, meshIn, readFrame, readMeshFile } from "../case-folder.js";
import { type Aligner, OPTIONS, type Tracker, type TrackOptions } from "../index.js";
import type { Done } from "./batch.js";
import { addBatchFlags, type BatchFlags, batchHelp } from "./batch-flags.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  depthKindHelp,
  statusHelp,
} from "./case-options.js";
import { depthRows } from "./depth-rows.js";
import { type FolderToDo, foldersToDo, videoKind } from "./folders.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { failedLine, failureOf, outcomeJson, trackJson } from "./outcome.js";
import { Output } from "./output.js";
import { type Live, runBatch } from "./run-batch.js";
import type { Style } from "./style.js";
import { type Column, fixed, headings, pairs, significant, tableLine } from "./table.js";
import { readTransform } from "./transform-file.js";
import { UsageError } from "./usage-error.js";

interface TrackFlags extends CaseFlags, BatchFlags, Readonly<Record<string, unknown>> {}

const help = `${caseFolderHelp}
A video needs a mask in its first frame only. Camera poses are not used.
${conventionsHelp}
${depthKindHelp}

Output
  A row per frame: state, confidence, scale and its standard deviation, and time.
  --json writes { "<video>": { scale, frames: { "<frame>": { scale, rotation, translation, matrix, quaternion, state,
  confidence, depthUnit, depthCalibration, … } } } }; a frame that failed has { error }. The scale of the video is the last one. A single video is written
  after each frame, several when each ends. --csv has a row per frame, VIDEO/FRAME.
${batchHelp(videoKind)}

Examples
  sim3align track videos/mug --json poses.json
  sim3align track 'videos/**' --jsonl videos.jsonl --resume --workers 4
  sim3align track videos/mug --known-extent 0.095 --known-extent-axis y
${statusHelp}`;

/** The command. */
export function trackCommand(): Command {
  const command = addBatchFlags(new Command("track"), videoKind)
    .summary("track the mesh of each video through its frames")
    .description("Tracks the object of a mesh through the frames of each video.");
  addOptionFlags(addCaseOptions(command), OPTIONS.track);
  return command.addHelpText("after", help).action(run);
}

const columns: readonly Column[] = [
  { heading: "frame", width: 24 },
  { heading: "state", width: 10 },
  ...["conf.", "scale", "± %", "time ms"].map((heading) => ({ heading, isNumber: true, width: 9 })),
];

async function run(args: string[], flags: TrackFlags): Promise<void> {
  const videos = await foldersToDo(videoKind, args, flags.list);
  for (const { folder } of videos) {
    if ((await frameNames(folder)).length === 0) throw new UsageError(`${folder} has no folder frame_*.`);
  }
  const output = new Output(flags);
  await runBatch(videos, flags, output, {
    run: (aligner, video, live) => trackVideo(aligner, video, flags, output, live),
  });
}

/** Tracks through a video. Only errors that concern all videos are thrown. */
async function trackVideo(
  aligner: Aligner,
  key: FolderToDo,
  flags: TrackFlags,
  output: Output,
  live?: Live,
): Promise<Done> {
  const { name, folder } = key;
  const { style }: { style: Style } = output;
  const frames: Parameters<typeof trackJson>[0][number][] = [];
  const rows: string[] = [];
  const print = (...lines: string[]) => (live === undefined ? rows.push(...lines) : live.lines(lines));
  let files: Readonly<Record<string, string>> = {};
  let tracker: Tracker | undefined;
  try {
    const names = await frameNames(folder);
    const given: Record<string, unknown> = givenOptions(flags, OPTIONS.track);
    if (typeof given.initial === "string") given.initial = await readTransform("initial", given.initial, name);
    const mesh = meshIn(folder);
    files = { mesh };
    tracker = await aligner.track(await readMeshFile(mesh), given as TrackOptions);
    print(style.bold(name), headings(columns));
    const read = (frame: string) => readFrame(join(folder, frame), caseSettings(flags));
    let next: ReturnType<typeof read> | undefined;
    for (const [k, frame] of names.entries()) {
      const began = performance.now();
      const row = [frame];
      let frameFiles: Readonly<Record<string, string>> = {};
      try {
        const reading = next ?? read(frame);
        next = undefined;
        const { files: own, input: view } = await reading;
        frameFiles = own;
        const { cameraToWorld, ...input } = view;
        const tracking = tracker.next(input);
        const following = names[k + 1];
        if (following !== undefined) {
          // The files of the next frame are read while the object is tracked in this one. What fails, fails in its turn.
          next = read(following);
          next.catch(() => {});
        }
        const tracked = await tracking;
        frames.push({ name: frame, tracked });
        const { state, confidence, scale, scaleSd } = tracked;
        row.push(state, fixed(confidence, 2), significant(scale, 5), fixed(100 * scaleSd, 2));
      } catch (error) {
        const failed = failureOf(frame, error, frameFiles);
        frames.push({ name: frame, tracked: failed });
        row.push(failed.error.code, "–", "–", "–");
      }
      row.push(fixed(performance.now() - began, 0));
      live?.partial(trackJson(frames));
      print(tableLine(columns, row));
      if (output.isClosed) break;
    }
    // How the last frame was read stands for the others.
    const last = frames.flatMap(({ tracked }) => ("error" in tracked ? [] : [tracked])).at(-1);
    if (last !== undefined) print(...pairs(depthRows(last)));
    return { key, entry: trackJson(frames), rows, remarks: [] };
  } catch (error) {
    const failed = failureOf(name, error, files);
    print(failedLine(failed, style));
    return { key, entry: outcomeJson(failed), rows, remarks: [] };
  } finally {
    tracker?.close();
  }
}
