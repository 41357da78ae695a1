/** `sim3align align`: aligns cases, and says how well. */
import { statSync } from "node:fs";
import { basename, resolve } from "node:path";
import { Command, Option } from "commander";
import { type CaseOnDisk, type CasePaths, type CaseSettings, readCaseFiles, readCaseFolder } from "../case-folder.js";
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
import { camera, direction, guard, jsonObject, number, scale, symmetry } from "./parse.js";
import { ProgressLine } from "./progress-line.js";
import { details, notes, summary } from "./report.js";
import { readTransform, transformFileHelp } from "./transform-file.js";
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
  quality?: NonNullable<AlignOptions["quality"]>;
  scale?: number | [number, number];
  knownExtent?: number;
  knownExtentAxis?: NonNullable<AlignOptions["knownExtentAxis"]>;
  initial?: string;
  search?: NonNullable<AlignOptions["search"]>;
  symmetry?: NonNullable<AlignOptions["symmetry"]>;
  cameraUp?: [number, number, number];
  meshUp?: [number, number, number];
  budgetMs?: number;
  lockScale?: boolean;
  voxelDivisions?: number;
  surfaceSamples?: number;
  maxObservedPoints?: number;
  guard?: [number, number] | "none";
  guardMode?: NonNullable<AlignOptions["guardMode"]>;
  ransacIterations?: number;
  icp?: NonNullable<AlignOptions["icp"]>;
  hallucinationFilter: boolean;
}

const help = `${caseFolderHelp}
${conventionsHelp}
${transformFileHelp}

Output
  A table with a row per case: confidence, the number of alternatives, scale, its ratio to the initial one, silhouette
  IoU, boundary F, centre drift, Chamfer distance, fitness, depth error and time; with gt.json, the errors against it
  too. A single case is shown in detail. The confidence is how likely the pose is right, 0 to 1; an alternative is
  another pose that explains the picture nearly as well.
  --json writes { "<case>": { scale, rotation, translation, matrix, quaternion, confidence, alternatives, uncertainty,
  metrics, timingsMs, counts, … } }; a case that failed has { error: { code, argument, found, expected, remedy,
  message } }.

Examples
  sim3align align cases/mug
  sim3align align cases/* --json results.json
  sim3align align cases/mug --known-extent 0.095 --known-extent-axis y
  sim3align align cases/mug --initial annotated.json --search local
  sim3align align cases/mug --camera-up 0,-1,0 --mesh-up 0,1,0 --quality best
  sim3align align cases/mug --preset paper --seed 7 --guard 0.8,1.2 --guard-mode clamp
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
    .addOption(new Option("--preset <name>", 'the method; "precise" by default').choices(["precise", "paper"]))
    .option("--seed <n>", "seed of all random draws: the same seed gives the same bits", number);
  addCaseOptions(command)
    .option("--surface-samples <n>", "points sampled on the mesh", number)
    .option("--max-observed-points <n>", "depth readings that are used at most", number)
    .option("--options <json>", "any options of align() as JSON; flags have precedence", jsonObject);
  preciseOptions(command.optionsGroup('Options of "precise":'));
  paperOptions(command.optionsGroup('Options of "paper":'));
  return command.addHelpText("after", help).action(run);
}

function preciseOptions(command: Command): void {
  command
    .addOption(new Option("--quality <how>", "how much work").choices(["fast", "balanced", "best"]))
    .option("--scale <a|min,max>", "the scale, or bounds of it, in metres per mesh unit", scale)
    .option("--known-extent <metres>", "the object's length along a side of the mesh's box", number)
    .addOption(new Option("--known-extent-axis <side>", "which side").choices(["longest", "x", "y", "z"]))
    .option("--initial <file>", "a transform file: a pose to start from")
    .addOption(new Option("--search <where>", "everywhere, or around --initial only").choices(["global", "local"]))
    .option("--symmetry <kind|json>", '"none", "auto", "auto-revolution" or [{"axis": [x, y, z], "fold": n}]', symmetry)
    .option("--camera-up <x,y,z>", "the direction that is up in the camera's frame; with --mesh-up", direction)
    .option("--mesh-up <x,y,z>", "the direction that is up in the mesh's frame", direction)
    .option("--budget-ms <ms>", "a bound on the work, counted as milliseconds of a machine of 2020", number)
    .option("--lock-scale", "keep the scale of --initial, or else of the grid of rotations");
}

function paperOptions(command: Command): void {
  command
    .option("--voxel-divisions <n>", "voxels along the observation's box diagonal", number)
    .option("--guard <min,max|none>", "bounds of the scale relative to the initial one", guard)
    .addOption(new Option("--guard-mode <mode>", "what happens beyond the guard").choices(["reject", "clamp"]))
    .option("--ransac-iterations <n>", "minimal sets drawn at most", number)
    .addOption(new Option("--icp <kind>", "the refinement").choices(["point-to-plane", "point-to-point", "none"]))
    .option("--no-lock-scale", "let the refinement change the scale")
    .option("--no-hallucination-filter", "use mesh regions that the observation does not support, too");
}

async function run(folders: string[], flags: AlignFlags): Promise<void> {
  const jobs = jobsOf(folders, flags);
  const output = new Output(flags.json);
  const aligner = await createAligner();
  const progress = new ProgressLine(process.stderr, jobs.length);
  const outcomes: Outcome[] = [];
  for (const job of jobs) {
    progress.begin(job.name);
    outcomes.push(await alignCase(aligner, job, flags, progress));
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
  read(): Promise<CaseOnDisk>;
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
  flags: AlignFlags,
  progress: ProgressLine,
): Promise<Outcome> {
  let files: CaseOnDisk["files"] = {};
  try {
    const { input, truth, ...read_ } = await read();
    files = read_.files;
    const options = alignOptions(flags);
    if (flags.initial !== undefined) options.initial = await readTransform("initial", flags.initial, name);
    const alignment = await aligner.align(input, { ...options, onProgress: (state) => progress.update(state) });
    const success: Success = { name, alignment, errors: null };
    if (truth === null) return success;
    const { transform, symmetry } = truth;
    const { errors } = await aligner.evaluate(input, alignment, { truth: transform, symmetry });
    return { ...success, errors };
  } catch (error) {
    if (isAboutOptions(error)) throw new UsageError(error.message);
    return failure(name, error, files);
  }
}

/** Whether every other case would fail in the same way; the initial pose may be another for each. */
function isAboutOptions(error: unknown): error is Sim3AlignError {
  if (!(error instanceof Sim3AlignError)) return false;
  return error.argument.startsWith("options") && !error.argument.startsWith("options.initial");
}

function alignOptions(flags: AlignFlags): AlignOptions {
  const { preset, seed, surfaceSamples, maxObservedPoints, lockScale } = flags;
  const { quality, scale, knownExtentAxis, search, symmetry, cameraUp, meshUp, budgetMs } = flags;
  const { voxelDivisions, guardMode, ransacIterations, icp } = flags;
  return {
    ...flags.options,
    ...withoutUndefined({ preset, seed, surfaceSamples, maxObservedPoints, lockScale }),
    ...withoutUndefined({ quality, scale, knownExtentM: flags.knownExtent, knownExtentAxis }),
    ...withoutUndefined({ search, symmetry, cameraUp, meshUp, budgetMs }),
    ...withoutUndefined({ voxelDivisions, guardMode, ransacIterations, icp }),
    ...(flags.guard === undefined ? {} : { guard: flags.guard === "none" ? null : flags.guard }),
    ...(flags.hallucinationFilter ? {} : { hallucinationFilter: false }),
  };
}
