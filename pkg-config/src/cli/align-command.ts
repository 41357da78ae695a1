/** `sim3align align`: aligns cases, and says how well. */
import { statSync } from "node:fs";
import { basename, resolve } from "node:path";
import { Command, Option } from "commander";
import { type Case, type CasePaths, type CaseSettings, readCaseFiles, readCaseFolder } from "../case-folder.js";
import { type Aligner, type AlignOptions, createAligner, Sim3AlignError } from "../index.js";
import { withoutUndefined } from "../values.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  statusHelp,
} from "./case-options.js";
import { failure, type Outcome, outcomesJson, type Success } from "./outcome.js";
import { Output } from "./output.js";
import { camera, guard, jsonObject, number } from "./parse.js";
import { ProgressLine } from "./progress-line.js";
import { details, notes, summary } from "./report.js";
import { UsageError } from "./usage-error.js";

interface AlignFlags extends CaseFlags {
  depth?: string;
  mask?: string;
  mesh?: string;
  camera?: CasePaths["camera"];
  json?: string;
  options?: Record<string, unknown>;
  preset?: NonNullable<AlignOptions["preset"]>;
  seed?: number;
  voxelDivisions?: number;
  surfaceSamples?: number;
  maxObservedPoints?: number;
  guard?: [number, number] | "none";
  guardMode?: NonNullable<AlignOptions["guardMode"]>;
  ransacIterations?: number;
  icp?: NonNullable<AlignOptions["icp"]>;
  lockScale: boolean;
  hallucinationFilter: boolean;
}

const help = `${caseFolderHelp}
${conventionsHelp}

Output
  A table with a row per case: scale, its ratio to the initial one, silhouette IoU, boundary F, centre drift, Chamfer
  distance, fitness, depth error and time; with gt.json, the errors against it too. A single case is shown in detail.
  --json writes { "<case>": { scale, rotation, translation, matrix, quaternion, metrics, timingsMs, counts, … } }; a
  case that failed has { error: { code, argument, found, expected, remedy, message } }.

Examples
  sim3align align cases/mug
  sim3align align cases/* --json results.json
  sim3align align cases/mug --seed 7 --guard 0.8,1.2 --guard-mode clamp
  sim3align align cases/mug --options '{"fpfhRadiusVoxels": 4}' --json - | jq .mug.scale
  sim3align align --depth d.png --mask m.png --mesh mug.glb --camera 600,600,320,240 --depth-scale 0.001
  sim3align align --depth d.npy --mask m.png --mesh mug.obj --camera fov:55
${statusHelp}`;

/** The command. */
export function alignCommand(): Command {
  const command = new Command("align")
    .summary("align cases: where the mesh is, and at what size")
    .description("Aligns the mesh of each case to its masked depth map.")
    .argument("[case...]", "case folders")
    .option("--depth <file>", "instead of a case folder: the depth map (.npy or 16-bit .png)")
    .option("--mask <file>", "… the mask (.png, .npy, or .json with COCO RLE)")
    .option("--mesh <file>", "… the mesh (.glb, .gltf, .obj, .ply or .stl)")
    .option(
      "--camera <file|fx,fy,cx,cy|fov:deg>",
      "… the camera: a file, intrinsics or a vertical field of view",
      camera,
    )
    .option("--json <file>", 'write the results as JSON; "-" is stdout')
    .addOption(new Option("--preset <name>", "the method").choices(["paper"]))
    .option("--seed <n>", "seed of all random draws: the same seed gives the same bits", number);
  return addCaseOptions(command)
    .option("--voxel-divisions <n>", "voxels along the observation's box diagonal", number)
    .option("--surface-samples <n>", "points sampled on the mesh", number)
    .option("--max-observed-points <n>", "depth readings that are used at most", number)
    .option("--guard <min,max|none>", "bounds of the scale relative to the initial one", guard)
    .addOption(new Option("--guard-mode <mode>", "what happens beyond the guard").choices(["reject", "clamp"]))
    .option("--ransac-iterations <n>", "minimal sets drawn at most", number)
    .addOption(new Option("--icp <kind>", "the refinement").choices(["point-to-plane", "point-to-point", "none"]))
    .option("--no-lock-scale", "let the refinement change the scale")
    .option("--no-hallucination-filter", "use mesh regions that the observation does not support, too")
    .option("--options <json>", "any options of align() as JSON; flags have precedence", jsonObject)
    .addHelpText("after", help)
    .action(run);
}

async function run(folders: string[], flags: AlignFlags): Promise<void> {
  const jobs = jobsOf(folders, flags);
  const output = new Output(flags.json);
  const aligner = await createAligner();
  const progress = new ProgressLine(process.stderr, jobs.length);
  const outcomes: Outcome[] = [];
  for (const job of jobs) {
    progress.begin(job.name);
    outcomes.push(await alignCase(aligner, job, alignOptions(flags), progress));
  }
  progress.clear();
  await output.json(outcomesJson(outcomes));
  output.lines(report(outcomes, output));
  if (outcomes.some((outcome) => "error" in outcome)) process.exitCode = 1;
}

function report(outcomes: readonly Outcome[], { style }: Output): string[] {
  const [only] = outcomes;
  if (outcomes.length === 1 && only !== undefined && !("error" in only)) return details(only, style);
  const remarks = notes(outcomes, style);
  return outcomes.length === 1
    ? remarks
    : [...summary(outcomes, style), ...(remarks.length > 0 ? ["", ...remarks] : [])];
}

/** A case to be read and aligned. */
interface Job {
  name: string;
  read(): Promise<Case>;
}

function jobsOf(folders: readonly string[], flags: AlignFlags): Job[] {
  const settings = caseSettings(flags);
  const { depth, mask, mesh, camera: cameraFlag } = flags;
  const given = [depth, mask, mesh, cameraFlag].filter((flag) => flag !== undefined).length;
  if (given === 0 && folders.length === 0)
    throw new UsageError("Name at least one case folder, or --depth, --mask, --mesh and --camera.");
  if (given === 0) return folderJobs(folders, settings);
  if (folders.length > 0)
    throw new UsageError("Name case folders, or --depth, --mask, --mesh and --camera, but not both.");
  if (depth === undefined || mask === undefined || mesh === undefined || cameraFlag === undefined) {
    throw new UsageError("--depth, --mask, --mesh and --camera belong together: name all four.");
  }
  const name = basename(mesh).replace(/\.[^.]*$/, "");
  return [{ name, read: () => readCaseFiles(name, { depth, mask, mesh, camera: cameraFlag }, settings) }];
}

/**
 * Cases are known by their folders' names, or by their paths where names repeat. Files among folders, which `cases/*`
 * may well name, are passed over.
 */
function folderJobs(paths: readonly string[], settings: CaseSettings): Job[] {
  const folders = paths.filter((path) => !statSync(path, { throwIfNoEntry: false })?.isFile());
  if (folders.length === 0) throw new UsageError(`No case folder among ${paths.join(", ")}.`);
  if (folders.length < paths.length) {
    console.error(`passed over, no folder: ${paths.filter((path) => !folders.includes(path)).join(", ")}`);
  }
  const names = folders.map((folder) => basename(resolve(folder)));
  return folders.map((folder, i) => {
    const name = names[i] ?? folder;
    const isUnique = names.indexOf(name) === names.lastIndexOf(name);
    return { name: isUnique ? name : folder, read: () => readCaseFolder(folder, settings) };
  });
}

async function alignCase(
  aligner: Aligner,
  { name, read }: Job,
  options: AlignOptions,
  progress: ProgressLine,
): Promise<Outcome> {
  let files: Case["files"] = {};
  try {
    const { input, truth, ...read_ } = await read();
    files = read_.files;
    const alignment = await aligner.align(input, { ...options, onProgress: (state) => progress.update(state) });
    const success: Success = { name, alignment, errors: null };
    if (truth === null) return success;
    const { matrix, symmetry } = truth;
    const { errors } = await aligner.evaluate(input, alignment, { truth: { matrix }, symmetry });
    return { ...success, errors };
  } catch (error) {
    if (isAboutOptions(error)) throw new UsageError(error.message);
    return failure(name, error, files);
  }
}

/** Whether every other case would fail in the same way. */
function isAboutOptions(error: unknown): error is Sim3AlignError {
  return error instanceof Sim3AlignError && error.argument.startsWith("options");
}

function alignOptions(flags: AlignFlags): AlignOptions {
  const { preset, seed, voxelDivisions, surfaceSamples, maxObservedPoints, guardMode, ransacIterations, icp } = flags;
  const named = { preset, seed, voxelDivisions, surfaceSamples, maxObservedPoints, guardMode, ransacIterations, icp };
  return {
    ...flags.options,
    ...withoutUndefined(named),
    ...(flags.guard === undefined ? {} : { guard: flags.guard === "none" ? null : flags.guard }),
    ...(flags.lockScale ? {} : { lockScale: false }),
    ...(flags.hallucinationFilter ? {} : { hallucinationFilter: false }),
  };
}
