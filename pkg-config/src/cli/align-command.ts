/** `sim3align align`: aligns cases and prints the results. */
import { availableParallelism } from "node:os";
import { Command, Option } from "commander";
import { MAX_WORKERS } from "../aligner-options.js";
import { createAligner } from "../index.js";
import { type AlignFlags, alignCase, paper, precise, shared } from "./align-case.js";
import { Batch } from "./batch.js";
import { addCaseOptions, caseFolderHelp, caseSettings, conventionsHelp, statusHelp } from "./case-options.js";
import { casePaths } from "./case-paths.js";
import { type CaseToDo, casesOf, type FileFlags } from "./cases.js";
import { concurrently } from "./concurrent.js";
import { csvHeadings } from "./csv-file.js";
import { onInterruption } from "./interruption.js";
import { addOptionFlags } from "./option-flags.js";
import { outcomeJson } from "./outcome.js";
import { Output, type OutputFlags } from "./output.js";
import { camera, jsonObject, workers } from "./parse.js";
import { drawEntry } from "./picture-inputs.js";
import { addPictureFlags, type PictureFlags, Pictures } from "./pictures.js";
import { ProgressLine } from "./progress-line.js";
import { Summary } from "./report.js";
import { transformFileHelp } from "./transform-file.js";

/** The flags of a batch. */
export interface BatchFlags extends AlignFlags, FileFlags, OutputFlags, PictureFlags {
  list?: string;
  workers?: number | "auto";
}

/** Cases that are read while several workers are busy. One worker aligns the cases in their order. */
const READ_AHEAD = 2;

/** The columns, in lines that fit the help. */
const columnsHelp = csvHeadings.join(", ").replace(/(.{80,100}), /g, "$1,\n  ");

const help = `${caseFolderHelp}
${conventionsHelp}
${transformFileHelp}

Output
  A table with a row per case: confidence, number of alternatives, scale, its ratio to the initial one, silhouette
  IoU, boundary F, centre drift, Chamfer distance, fitness, depth error and time; with gt.json also the errors against
  it. A single case is shown in detail. The confidence is the probability that the pose is right, 0 to 1. An alternative
  is another pose that explains the observation nearly as well.
  Rows and entries are written when a case is done, in the order in which the cases end; with --workers 1, in that of the
  command line. An interruption loses nothing: the files hold what is done.
  --json writes { "<case>": { scale, rotation, translation, matrix, quaternion, confidence, alternatives, uncertainty,
  metrics, warnings, timingsMs, diagnostics } }; a case that failed has { error: { code, argument, found, expected,
  remedy, message } }. With --preset paper, confidence and uncertainty are null and alternatives is empty.
  A case with frames has { scale, rotation, translation, …, frames: { "<frame>": { scale, rotation, translation, …,
  confidence, role, camera } } }: its own pose is world from mesh, if the camera poses are known; those of the frames are
  camera from mesh.
  --jsonl writes the same entries, a line each: { "case": "<case>", … }. It is the record of a batch: after an
  interruption, of whatever kind, the same command with --resume aligns what is missing. A line that was cut off is removed.
  Cases that failed count as done; remove their lines to align them again. --json and --csv are then written anew from it.
  --csv writes the columns ${columnsHelp}.
  --report writes a folder with index.html, which a browser opens from disk: a table to sort and filter, and for each case
  its picture with mask, mesh and depth difference, its alternatives, and a view in 3D. Cases with frames have a row per frame.
  --overlay writes <case>.png, the whole image with the mask and the mesh; --glb writes <case>.glb, the posed mesh in the
  frame of a glTF camera at the origin. Other characters than a-z, 0-9, ".", "_" and "-" change the name of the file.

Batches
  The cases are aligned side by side; the results do not depend on --workers. Each is read when its turn comes: memory
  grows with the number of workers, not with that of the cases. A pattern in quotes is expanded by this program:
  * and ? within a name, [abc], {a,b}, and ** for folders at any depth, of which those with a mesh are cases. Paths in a
  list are relative to the current folder, and stand for themselves; empty lines and lines that begin with # are skipped.
  A terminal shows a bar with rate, time left and failures; elsewhere, a batch of 20 or more prints a line per tenth.

Examples
  sim3align align cases/mug
  sim3align align cases/* --json results.json
  sim3align align 'cases/**' --jsonl results.jsonl --csv results.csv --resume
  find cases -name mesh.glb -printf '%h\\n' | sim3align align --list - --workers 4 --jsonl -
  sim3align align 'cases/**' --jsonl results.jsonl --report report --resume
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
    .argument("[case...]", "case folders, or patterns such as 'cases/*'")
    .option("--list <file>", 'a file with the path of a case folder per line; "-" is stdin')
    .option("--depth <file>", "depth map (.npy or 16-bit .png), instead of a case folder")
    .option("--mask <file>", "mask (.png, .npy, or .json with COCO RLE)")
    .option("--mesh <file>", "mesh (.glb, .gltf, .obj, .ply or .stl)")
    .option("--camera <file|fx,fy,cx,cy|fov:deg>", "camera: a file, intrinsics or a vertical field of view", camera)
    .option("--image <file>", "photo (.png or .jpg) with the field of view of the depth map")
    .option("--json <file>", 'write the results as JSON; "-" is stdout')
    .option("--jsonl <file>", 'write a line of JSON for each case when it is done; "-" is stdout')
    .option("--resume", "go on: skip the cases in the file of --jsonl, and append to it")
    .option("--csv <file>", 'write a table of comma-separated values; "-" is stdout')
    .option("--workers <n|auto>", "cases aligned at a time (1 to 64; default auto: one per core)", workers)
    .addOption(new Option("--preset <name>", "method (default precise)").choices(["precise", "paper"]));
  addOptionFlags(addCaseOptions(addPictureFlags(command)), shared);
  command.option("--options <json>", "further options of align() as JSON; flags take precedence", jsonObject);
  addOptionFlags(command.optionsGroup("Options of --preset precise:"), precise);
  addOptionFlags(command.optionsGroup("Options of --preset paper:"), paper);
  return command.addHelpText("after", help).action(run);
}

async function run(args: string[], flags: BatchFlags): Promise<void> {
  const cases = casesOf(await casePaths(args, flags.list), flags, caseSettings(flags));
  await alignBatch(cases, flags, new Output(flags));
}

/** Aligns cases, and writes and prints their results. */
export async function alignBatch(cases: readonly CaseToDo[], flags: BatchFlags, output: Output): Promise<void> {
  const pictures = await Pictures.open(flags);
  const batch = new Batch(cases.length, output, pictures, flags);
  let left: readonly CaseToDo[] = cases;
  if (flags.resume) {
    const done = await resumed(output, batch, pictures, cases, flags);
    left = cases.filter(({ name }) => !done.has(name));
    console.error(`resumed: ${done.size} of ${cases.length} cases are in ${flags.jsonl}`);
  }
  const stop = onInterruption(() => batch.interrupt());
  if (cases.length === 1) await alignOne(left, flags, batch, pictures);
  else await alignMany(left, flags, batch, output, pictures);
  stop();
  batch.end();
  if (batch.hasFailure) process.exitCode = 1;
}

/**
 * Adds the entries of an interrupted batch to the output, and draws what was not drawn. Returns the names of those that
 * belong to this one.
 */
async function resumed(
  output: Output,
  batch: Batch,
  pictures: Pictures,
  cases: readonly CaseToDo[],
  flags: BatchFlags,
): Promise<ReadonlySet<string>> {
  const known = new Map(cases.map((each) => [each.name, each]));
  const done = new Set<string>();
  for await (const { name, entry } of output.resumed()) {
    const each = known.get(name);
    if (each === undefined) continue;
    done.add(name);
    await drawEntry(pictures, each, entry, flags, true);
    batch.skip("error" in entry);
    batch.picture(name, entry);
  }
  return done;
}

/** Aligns the only case, on this thread unless the flags ask for workers. */
async function alignOne(
  cases: readonly CaseToDo[],
  flags: BatchFlags,
  batch: Batch,
  pictures: Pictures,
): Promise<void> {
  const [only] = cases;
  if (only === undefined) return;
  const aligner = await createAligner({ workers: flags.workers === "auto" ? 0 : (flags.workers ?? 0) });
  const progress = new ProgressLine(process.stderr, 1);
  progress.begin(only.name);
  const outcome = await alignCase(aligner, only, flags, (state) => progress.update(state)).finally(() => {
    progress.clear();
    aligner.dispose();
  });
  await drawEntry(pictures, only, outcomeJson(outcome), flags);
  batch.add(outcome, []);
}

/** Aligns cases side by side. Each is read when its turn comes. */
async function alignMany(
  cases: readonly CaseToDo[],
  flags: BatchFlags,
  batch: Batch,
  output: Output,
  pictures: Pictures,
): Promise<void> {
  if (cases.length === 0) return;
  const { workers = "auto" } = flags;
  const size = Math.min(workers === "auto" ? availableParallelism() : workers, cases.length, MAX_WORKERS);
  const aligner = await createAligner({ workers: size });
  const summary = new Summary(cases, output.style);
  batch.begin(cases.length);
  try {
    const align = async (each: CaseToDo) => {
      const outcome = await alignCase(aligner, each, flags);
      // Before the record: a case that is there needs no other pictures.
      await drawEntry(pictures, each, outcomeJson(outcome), flags);
      return outcome;
    };
    for await (const outcome of concurrently(cases, size === 1 ? 1 : size + READ_AHEAD, align)) {
      batch.add(outcome, summary.lines(outcome));
      if (output.isClosed) break;
    }
  } finally {
    batch.clear();
    aligner.dispose();
  }
}
