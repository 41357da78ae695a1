/** `sim3align track`: tracks an object through videos and prints the results. */
import { basename, join, resolve } from "node:path";
import { Command } from "commander";
import { type CaseSettings, frameNames, meshIn, readFrame, readMeshFile } from "../case-folder.js";
import { type Aligner, createAligner, OPTIONS, type Tracker, type TrackOptions } from "../index.js";
import { isAboutOptions } from "./align-case.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  statusHelp,
} from "./case-options.js";
import { onInterruption } from "./interruption.js";
import { fixed, significant } from "./number.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { failure, failureText, outcomeJson, trackJson } from "./outcome.js";
import { Output } from "./output.js";
import { type Column, headings, tableLine } from "./table.js";
import { readTransform } from "./transform-file.js";
import { UsageError } from "./usage-error.js";

interface TrackFlags extends CaseFlags, Readonly<Record<string, unknown>> {
  json?: string;
}

const help = `${caseFolderHelp}
A video needs a mask in its first frame only. Camera poses are not used.
${conventionsHelp}

Output
  A row per frame: state, confidence, scale and its standard deviation, and time.
  --json writes { "<video>": { scale, frames: { "<frame>": { scale, rotation, translation, matrix, quaternion, state,
  confidence, … } } } } after each frame; a frame that failed has { error }. The scale of the video is the last one.

Examples
  sim3align track videos/mug --json poses.json
  sim3align track videos/mug --known-extent 0.095 --known-extent-axis y
${statusHelp}`;

/** The command. */
export function trackCommand(): Command {
  const command = new Command("track")
    .summary("track the mesh of each video through its frames")
    .description("Tracks the object of a mesh through the frames of each video.")
    .argument("<video...>", "folders with a mesh and frame_* folders")
    .option("--json <file>", 'write the results as JSON; "-" is stdout');
  addOptionFlags(addCaseOptions(command), OPTIONS.track);
  return command.addHelpText("after", help).action(run);
}

const columns: readonly Column[] = [
  { heading: "frame", width: 24 },
  { heading: "state", width: 10 },
  ...["conf.", "scale", "± %", "time ms"].map((heading) => ({ heading, isNumber: true, width: 9 })),
];

async function run(folders: string[], flags: TrackFlags): Promise<void> {
  const output = new Output(flags);
  const aligner = await createAligner();
  const stop = onInterruption(() => output.end());
  let hasFailed = false;
  for (const folder of folders) {
    hasFailed = !(await trackVideo(aligner, folder, flags, output)) || hasFailed;
    if (output.isClosed) break;
  }
  stop();
  output.end();
  if (hasFailed) process.exitCode = 1;
}

/** Returns whether all frames succeeded. */
async function trackVideo(aligner: Aligner, folder: string, flags: TrackFlags, output: Output): Promise<boolean> {
  const name = basename(resolve(folder));
  const settings: CaseSettings = caseSettings(flags);
  const frames: Parameters<typeof trackJson>[0][number][] = [];
  let files: Readonly<Record<string, string>> = {};
  let tracker: Tracker | undefined;
  try {
    const names = await frameNames(folder);
    if (names.length === 0) throw new UsageError(`${folder} has no folder frame_*.`);
    const given: Record<string, unknown> = givenOptions(flags, OPTIONS.track);
    if (typeof given.initial === "string") given.initial = await readTransform("initial", given.initial, name);
    const mesh = meshIn(folder);
    files = { mesh };
    tracker = await aligner.track(await readMeshFile(mesh), given as TrackOptions);
    output.lines([output.style.bold(name), headings(columns)]);
    for (const [k, frame] of names.entries()) {
      const began = performance.now();
      const row = [frame];
      let frameFiles: Readonly<Record<string, string>> = {};
      try {
        const read = await readFrame(join(folder, frame), settings);
        frameFiles = read.files;
        const { cameraToWorld, ...input } = read.input;
        const tracked = await tracker.next(input);
        frames.push({ name: frame, tracked });
        const { state, confidence, scale, scaleSd } = tracked;
        row.push(state, fixed(confidence, 2), significant(scale, 5), fixed(100 * scaleSd, 2));
      } catch (error) {
        const failed = failure(frame, error, frameFiles);
        frames.push({ name: frame, tracked: failed });
        row.push(failed.error.code, "–", "–", "–");
      }
      row.push(fixed(performance.now() - began, 0));
      output.add(name, trackJson(frames), k + 1 === names.length);
      output.lines([tableLine(columns, row)]);
      if (output.isClosed) break;
    }
    return !frames.some(({ tracked }) => "error" in tracked);
  } catch (error) {
    if (error instanceof UsageError) throw error;
    if (isAboutOptions(error)) throw new UsageError(error.message);
    const failed = failure(name, error, files);
    output.add(name, outcomeJson(failed));
    output.lines([output.style.red("failed ") + failureText(failed)]);
    return false;
  } finally {
    tracker?.close();
  }
}
