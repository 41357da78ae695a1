/** `sim3align align`: aligns cases and prints the results. */
import { Command, Option } from "commander";
import { type CaseOnDisk, frameNames, readFrames } from "../case-folder.js";
import {
  type Aligner,
  type AlignInput,
  createAligner,
  OPTIONS,
  type OptionRow,
  type OptionsOf,
  type Preset,
  type Progress,
  Sim3AlignError,
  type ViewsOptions,
} from "../index.js";
import { withoutUndefined } from "../values.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  statusHelp,
} from "./case-options.js";
import { type CaseToDo, casesOf, type FileFlags } from "./cases.js";
import { onInterruption } from "./interruption.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { failure, type Outcome, outcomeJson, type Success } from "./outcome.js";
import { Output } from "./output.js";
import { camera, jsonObject } from "./parse.js";
import { ProgressLine } from "./progress-line.js";
import { details, notes, Summary, viewsDetails } from "./report.js";
import { readTransform, transformFileHelp } from "./transform-file.js";
import { UsageError } from "./usage-error.js";

interface AlignFlags extends CaseFlags, FileFlags, Readonly<Record<string, unknown>> {
  json?: string;
  options?: Record<string, unknown>;
  preset?: Preset;
}

const shared = OPTIONS.align.filter(({ name }) => OPTIONS.paper.some((row) => row.name === name));
const isShared = ({ name }: OptionRow) => shared.some((row) => row.name === name);
const precise: readonly OptionRow[] = OPTIONS.align.filter((row) => !isShared(row));
const paper: readonly OptionRow[] = OPTIONS.paper.filter((row) => !isShared(row));

const help = `${caseFolderHelp}
${conventionsHelp}
${transformFileHelp}

Output
  A table with a row per case: confidence, number of alternatives, scale, its ratio to the initial one, silhouette
  IoU, boundary F, centre drift, Chamfer distance, fitness, depth error and time; with gt.json also the errors against
  it. A single case is shown in detail. The confidence is the probability that the pose is right, 0 to 1. An alternative
  is another pose that explains the observation nearly as well.
  The row of a case, and its entry in the file of --json, are written when the case is done: an interruption loses
  nothing.
  --json writes { "<case>": { scale, rotation, translation, matrix, quaternion, confidence, alternatives, uncertainty,
  metrics, warnings, timingsMs, diagnostics } }; a case that failed has { error: { code, argument, found, expected,
  remedy, message } }. With --preset paper, confidence and uncertainty are null and alternatives is empty.
  A case with frames has { scale, rotation, translation, …, frames: { "<frame>": { scale, rotation, translation, …,
  confidence, role, camera } } }: its own pose is world from mesh, if the camera poses are known; those of the frames are
  camera from mesh.

Examples
  sim3align align cases/mug
  sim3align align cases/* --json results.json
  sim3align align views/mug
  sim3align align cases/mug --known-extent 0.095 --known-extent-axis y
  sim3align align cases/mug --initial annotated.json --search local
  sim3align align cases/mug --camera-up 0,-1,0 --mesh-up 0,1,0 --quality best
  sim3align align cases/mug --preset paper --seed 7 --guard 0.8,1.2 --guard-mode clamp
  sim3align align cases/mug --options '{"fpfhRadiusVoxels": 4}' --json - | jq .mug.scale
  sim3align align --depth d.png --mask m.png --mesh mug.glb --camera 600,600,320,240 --depth-scale 0.001
  sim3align align --depth d.npy --mask m.png --mesh mug.obj --camera fov:55 --image photo.jpg
${statusHelp}`;

/** The command. */
export function alignCommand(): Command {
  const command = new Command("align")
    .summary("align the mesh of each case to its depth map")
    .description("Aligns the mesh of each case to its masked depth map.")
    .argument("[case...]", "case folders")
    .option("--depth <file>", "depth map (.npy or 16-bit .png), instead of a case folder")
    .option("--mask <file>", "mask (.png, .npy, or .json with COCO RLE)")
    .option("--mesh <file>", "mesh (.glb, .gltf, .obj, .ply or .stl)")
    .option("--camera <file|fx,fy,cx,cy|fov:deg>", "camera: a file, intrinsics or a vertical field of view", camera)
    .option("--image <file>", "photo (.png or .jpg) with the field of view of the depth map")
    .option("--json <file>", 'write the results as JSON; "-" is stdout')
    .addOption(new Option("--preset <name>", "method (default precise)").choices(["precise", "paper"]));
  addOptionFlags(addCaseOptions(command), shared);
  command.option("--options <json>", "further options of align() as JSON; flags take precedence", jsonObject);
  addOptionFlags(command.optionsGroup("Options of --preset precise:"), precise);
  addOptionFlags(command.optionsGroup("Options of --preset paper:"), paper);
  return command.addHelpText("after", help).action(run);
}

async function run(folders: string[], flags: AlignFlags): Promise<void> {
  const cases = casesOf(folders, flags, caseSettings(flags));
  const output = new Output(flags.json);
  const aligner = await createAligner();
  const progress = new ProgressLine(process.stderr, cases.length);
  const summary = cases.length === 1 ? undefined : new Summary(cases, output.style);
  const outcomes: Outcome[] = [];
  const end = () => {
    progress.clear();
    output.results?.end();
    output.lines(remarks(outcomes, output));
  };
  const stop = onInterruption(() => {
    end();
    const place = flags.json === undefined || flags.json === "-" ? "" : `; they are in ${flags.json}`;
    console.error(`interrupted: ${outcomes.length} of ${cases.length} cases are done${place}`);
  });
  for (const each of cases) {
    progress.begin(each.name);
    const outcome = await alignCase(aligner, each, flags, progress);
    progress.clear();
    outcomes.push(outcome);
    output.results?.add(outcome.name, outcomeJson(outcome));
    if (summary !== undefined) output.lines(summary.lines(outcome));
    if (output.isClosed) break;
  }
  stop();
  end();
  if (outcomes.some((outcome) => "error" in outcome)) process.exitCode = 1;
}

/** What follows the table: details of a single case, or the warnings and failures of all. */
function remarks(outcomes: readonly Outcome[], { style }: Output): string[] {
  const [only] = outcomes;
  if (outcomes.length === 1 && only !== undefined && !("error" in only)) {
    return "views" in only ? viewsDetails(only, style) : details(only, style);
  }
  const lines = notes(outcomes, style);
  return outcomes.length === 1 || lines.length === 0 ? lines : ["", ...lines];
}

async function alignCase(
  aligner: Aligner,
  { name, folder, read }: CaseToDo,
  flags: AlignFlags,
  progress: ProgressLine,
): Promise<Outcome> {
  let files: CaseOnDisk["files"] = {};
  try {
    if (folder !== undefined && (await frameNames(folder)).length > 0) {
      return await alignFrames(aligner, name, folder, flags, progress);
    }
    const { input, truth, ...read_ } = await read();
    files = read_.files;
    const options = await alignOptions(flags, name);
    const alignment = await aligner.align(input, { ...options, onProgress: (state) => progress.update(state) });
    const success: Success = { name, alignment, errors: null };
    if (truth === null) return success;
    const { transform, symmetry } = truth;
    const { errors } = await aligner.evaluate(input, alignment, { truth: transform, symmetry });
    return { ...success, errors };
  } catch (error) {
    if (error instanceof UsageError) throw error;
    if (isAboutOptions(error)) throw new UsageError(error.message);
    return failure(name, error, files);
  }
}

/** Aligns a case of several views. Without the camera poses of all frames, those of some do not help. */
async function alignFrames(
  aligner: Aligner,
  name: string,
  folder: string,
  flags: AlignFlags,
  progress: ProgressLine,
): Promise<Outcome> {
  const { mesh, frames } = await readFrames(folder, caseSettings(flags));
  const isKnown = frames.every(({ input }) => input.cameraToWorld !== undefined);
  const views = frames.map(({ input }) => (isKnown ? input : { ...input, cameraToWorld: undefined }));
  const { preset, ...options } = await alignOptions(flags, name);
  if (preset === "paper") throw new UsageError(`${name} has several frames, for which --preset paper has no method.`);
  const onProgress = (state: Progress) => progress.update(state);
  const alignment = await aligner.alignViews({ mesh, views }, { ...(options as ViewsOptions), onProgress });
  const errors = await Promise.all(
    frames.map(async ({ input, truth }, k) => {
      const pose = alignment.views[k];
      if (truth === null || pose === undefined || input.mask === undefined) return null;
      const { cameraToWorld, ...frame } = input;
      const { transform, symmetry } = truth;
      const found = await aligner.evaluate({ ...frame, mesh } as AlignInput, pose, { truth: transform, symmetry });
      return found.errors;
    }),
  );
  return { name, views: alignment, frames: frames.map((frame) => frame.name), errors };
}

/** Whether all cases would fail with this error. The initial pose may differ from case to case. */
export function isAboutOptions(error: unknown): error is Sim3AlignError {
  if (!(error instanceof Sim3AlignError)) return false;
  return error.argument.startsWith("options") && !error.argument.startsWith("options.initial");
}

/** The options set by `--options` and by flags. */
async function alignOptions(flags: AlignFlags, name: string): Promise<OptionsOf<Preset, boolean>> {
  const given: Record<string, unknown> = {
    ...flags.options,
    ...givenOptions(flags, [...shared, ...precise, ...paper]),
    ...withoutUndefined({ preset: flags.preset }),
  };
  if (typeof given.initial === "string") given.initial = await readTransform("initial", given.initial, name);
  return given as unknown as OptionsOf<Preset, boolean>;
}
