/** `sim3align align`: aligns cases and prints the results. */
import { Command, Option } from "commander";
import { type AlignFlags, alignCase, paper, precise, shared } from "./align-case.js";
import { addBatchFlags, type BatchFlags, batchHelp } from "./batch-flags.js";
import {
  addCaseOptions,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  depthKindHelp,
  statusHelp,
} from "./case-options.js";
import { type CaseToDo, caseOfFiles, casesIn, type FileFlags } from "./cases.js";
import { csvHeadings } from "./csv-file.js";
import { caseKind, foldersToDo } from "./folders.js";
import { addOptionFlags } from "./option-flags.js";
import { type Outcome, outcomeJson } from "./outcome.js";
import { Output } from "./output.js";
import { camera, jsonObject } from "./parse.js";
import { addPictureFlags, drawEntry, inputsOfCase, type PictureFlags } from "./pictures.js";
import { details, notes, summaryTable, viewsDetails } from "./report.js";
import { runBatch } from "./run-batch.js";
import { transformFileHelp } from "./transform-file.js";

/** The flags of a batch of cases. */
export interface CaseBatchFlags extends AlignFlags, FileFlags, BatchFlags, PictureFlags {
  list?: string;
}

/** The columns, in lines that fit the help. */
const columnsHelp = csvHeadings.join(", ").replace(/(.{80,100}), /g, "$1,\n  ");

const help = `${caseFolderHelp}
${conventionsHelp}
${depthKindHelp}
${transformFileHelp}

Output
  A table with a row per case: confidence, number of alternatives, scale, its ratio to the initial one, silhouette
  IoU, boundary F, centre drift, Chamfer distance, fitness, depth error and time; with gt.json also the errors against
  it. A single case is shown in detail. The confidence is the probability that the pose is right, 0 to 1. An alternative
  is another pose that explains the observation nearly as well.
  --json writes { "<case>": { scale, rotation, translation, matrix, quaternion, confidence, turnConfidence, alternatives,
  uncertainty, proportions, metrics, warnings, depthUnit, cameraSource, depthCalibration, timingsMs, diagnostics } };
  proportions, cameraSource and depthCalibration where there are any. A case that failed has { error: { code, argument,
  found, expected, remedy, message } }. With --preset paper, confidences and uncertainty are null and alternatives is empty.
  A case with frames has { scale, rotation, translation, …, frames: { "<frame>": { scale, rotation, translation, …,
  confidence, role, camera } } }: its own pose is world from mesh, if the camera poses are known; those of the frames are
  camera from mesh.
  --csv writes the columns ${columnsHelp}.
  --report writes a folder with index.html, which a browser opens from disk: a table to sort and filter, and for each case
  its picture with mask, mesh and depth difference, its alternatives, and a view in 3D. Cases with frames have a row per frame.
  --overlay writes <case>.png, the whole image with the mask and the mesh; --glb writes <case>.glb, the posed mesh in the
  frame of a glTF camera at the origin. Other characters than a-z, 0-9, ".", "_" and "-" change the name of the file.
${batchHelp(caseKind)}

Examples
  sim3align align cases/mug
  sim3align align cases/* --json results.json
  sim3align align 'cases/**' --jsonl results.jsonl --csv results.csv --resume
  find cases -name mesh.glb -printf '%h\\n' | sim3align align --list - --workers 4 --jsonl -
  sim3align align 'cases/**' --jsonl results.jsonl --report report --resume
  sim3align align views/mug --json views.json
  sim3align align cases/mug --known-extent 0.095 --known-extent-axis y
  sim3align align cases/mug --initial annotated.json --search local
  sim3align align cases/mug --camera-up 0,-1,0 --mesh-up 0,1,0 --quality best
  sim3align align cases/mug --preset paper --seed 7 --guard 0.8,1.2 --guard-mode clamp
  sim3align align cases/mug --preset paper --options '{"fpfhRadiusVoxels": 4}' --json - | jq .mug.scale
  sim3align align --depth d.png --mask m.png --mesh mug.glb --camera 600,600,320,240 --depth-scale 0.001
  sim3align align --depth d.npy --mask m.png --mesh mug.obj --camera fov:55 --image photo.jpg
  sim3align align photo.jpg --depth moge.npz --mask m.png --mesh mug.glb
  sim3align align photo.jpg --depth d.npy --mask m.png --mesh mug.glb --depth-kind affine-invariant-disparity
  sim3align align cases/mug --depth-kind affine-invariant-disparity --known-extent 0.095 --known-extent-axis y
${statusHelp}`;

/** The command. */
export function alignCommand(): Command {
  const command = addBatchFlags(new Command("align"), caseKind)
    .summary("align the mesh of each case to its depth map")
    .description("Aligns the mesh of each case to its masked depth map.")
    .option("--depth <file>", "depth map (.npy, 16-bit .png, .npz, .exr, .tiff or .pfm), instead of a case folder")
    .option("--mask <file>", "mask (.png, .npy, or .json with COCO RLE)")
    .option("--mesh <file>", "mesh (.glb, .gltf, .obj, .ply or .stl)")
    .option("--camera <file|fx,fy,cx,cy|fov:deg>", "camera: a file, intrinsics or a vertical field of view", camera)
    .option("--image <file>", "photo (.png or .jpg) with the field of view of the depth map, also without the flag")
    .addOption(new Option("--preset <name>", "method (default precise)").choices(["precise", "paper"]));
  addOptionFlags(addCaseOptions(addPictureFlags(command)), shared);
  command.option("--options <json>", "further options of align() as JSON; flags take precedence", jsonObject);
  addOptionFlags(command.optionsGroup("Options of --preset precise:"), precise);
  addOptionFlags(command.optionsGroup("Options of --preset paper:"), paper);
  return command.addHelpText("after", help).action(run);
}

async function run(args: string[], flags: CaseBatchFlags): Promise<void> {
  const settings = caseSettings(flags);
  const only = caseOfFiles(flags, args, flags.list !== undefined, settings);
  const cases = only === undefined ? casesIn(await foldersToDo(caseKind, args, flags.list), settings) : [only];
  await alignBatch(cases, flags, new Output(flags));
}

/** Aligns cases, and writes and prints their results. */
export async function alignBatch(cases: readonly CaseToDo[], flags: CaseBatchFlags, output: Output): Promise<void> {
  const summary = summaryTable(cases, output.style);
  await runBatch(cases, flags, output, {
    async run(aligner, each, live) {
      const outcome = await alignCase(aligner, each, flags, live?.progress);
      const [rows, remarks] =
        live === undefined
          ? [summary(each.name, outcome), notes([outcome], output.style)]
          : [[], only(outcome, output)];
      return { key: each, entry: outcomeJson(outcome), rows, remarks };
    },
    draw: (pictures, each, entry, isResumed) =>
      drawEntry(pictures, each.name, entry, isResumed, () => inputsOfCase(each, entry, flags)),
  });
}

/** What is printed of a single case. */
function only(outcome: Outcome, { style }: Output): string[] {
  if ("error" in outcome) return notes([outcome], style);
  return "views" in outcome ? viewsDetails(outcome, style) : details(outcome, style);
}
