/** `sim3align bop`: aligns the targets of a BOP dataset, writes the results file of its leaderboard, and scores it. */
import { writeFileSync } from "node:fs";
import { Command } from "commander";
import { BopDataset, type BopModelInfo, type BopTarget, mostVisible, targetKey } from "../bop-dataset.js";
import { bopId, bopMaskPath, readBopImage } from "../bop-folder.js";
import { type CaseOnDisk, read } from "../case-folder.js";
import { fromBop } from "../conventions/bop.js";
import type { KnownPose } from "../conventions/pose-file.js";
import type { AlignInput } from "../index.js";
import { precise, shared } from "./align-case.js";
import { alignBatch, type CaseBatchFlags } from "./align-command.js";
import { addRecordFlags } from "./batch-flags.js";
import { Detections } from "./bop-detections.js";
import { type BopEvaluation, evaluateBop } from "./bop-evaluation.js";
import { bopModelsIn } from "./bop-models.js";
import { type BopInstance, BopResultsFile, METRES_PER_UNIT, readResults, resultsName } from "./bop-results.js";
import { conventionsHelp, statusHelp } from "./case-options.js";
import type { CaseToDo } from "./cases.js";
import { addOptionFlags } from "./option-flags.js";
import { Output } from "./output.js";
import { jsonObject } from "./parse.js";
import { addPictureFlags } from "./pictures.js";
import { StatusLine } from "./status-line.js";
import { fixed, pairs } from "./table.js";
import { UsageError } from "./usage-error.js";
import { checkWritable } from "./writable.js";

interface BopFlags extends CaseBatchFlags {
  split: string;
  masks: string;
  models?: string;
  targets?: string;
  method: string;
  csv?: string;
  evaluate?: string | true;
  scores?: string;
}

/** The options that make sense for targets whose size is known. */
const options = [...shared, ...precise].filter(({ name }) => ["quality", "workBudget", "seed"].includes(name));

const help = `
A dataset is a folder as BOP publishes it
  models/obj_000001.ply, …       the models, in millimetres; for --evaluate also models_info.json, in models_eval or models
  SPLIT/SCENE/                   depth/, rgb/ (optional), scene_camera.json and, where they are public, scene_gt.json,
                                 scene_gt_info.json and mask_visib/
  test_targets_bop19.json        what is to be found in a test split; elsewhere, all objects that are a tenth visible
${conventionsHelp}

Masks
  --masks gt takes those of the dataset: mask_visib of the most visible instances. A file has 2D detections in BOP's format,
  such as those of CNOS: a list of { scene_id, image_id, category_id, score, segmentation, time }, the masks in COCO RLE. Of
  each object, as many of the best detections are aligned as there are instances; the time of the detections is added.

Output
  The results file METHOD_DATASET-SPLIT.csv, or METHOD_DATASET-SPLIT_NAME.csv with --csv NAME, in the current folder: scene_id,
  im_id, obj_id, score, R, t in millimetres, and the time, which is the sum over the objects of the image. The score is the
  confidence, multiplied by that of the detection. --jsonl, --resume, --json, --workers, --report, --overlay and --glb work
  as those of "align": cases are called SCENE/IMAGE/OBJECT-INSTANCE.
  --evaluate compares the results, or those of a file, with the true poses: average recalls of VSD, MSSD and MSPD, their mean,
  and recall of ADD and ADD-S below a tenth of the diameter. --scores writes them as JSON, with the errors of each pose.

Examples
  sim3align bop bop/ycbv --split test --jsonl ycbv.jsonl --resume
  sim3align bop bop/lmo --split test --masks cnos_lmo-test.json --csv cnos --evaluate
  sim3align bop bop/tless --split test_primesense --models bop/tless/models_cad
  sim3align bop bop/lmo --split test --evaluate other_lmo-test.csv --scores scores.json
${statusHelp}`;

/** The command. */
export function bopCommand(): Command {
  const command = addRecordFlags(new Command("bop"), "pose")
    .summary("align the targets of a BOP dataset, and score poses as BOP does")
    .description(
      "Aligns each target of a BOP dataset, at its known size, and writes the results file of the leaderboard.",
    )
    .argument("<dataset>", "the folder of the dataset")
    .requiredOption("--split <name>", "the folder of the split, such as test or test_primesense")
    .option("--masks <gt|file>", "masks of the dataset, or a file with 2D detections", "gt")
    .option("--models <folder>", "the models to align")
    .option("--targets <file>", "what to find, as in test_targets_bop19.json")
    .option("--method <name>", "the first part of the name of the results file", "sim3align")
    .option("--csv <name>", "the last part of the name of the results file")
    .option("--evaluate [file]", "score the results, or only those of a file")
    .option("--scores <file>", 'write the scores as JSON; "-" is stdout')
    .option("--no-image", "do not read the photos: align by shape alone");
  addOptionFlags(addPictureFlags(command), options);
  command.option("--options <json>", "further options of align() as JSON; flags take precedence", jsonObject);
  return command.addHelpText("after", help).action(run);
}

async function run(folder: string, flags: BopFlags): Promise<void> {
  if (flags.scores !== undefined && flags.scores !== "-") checkWritable("--scores", flags.scores);
  if (flags.scores !== undefined && flags.evaluate === undefined) throw new UsageError("--scores needs --evaluate.");
  const dataset = new BopDataset(folder, flags.split);
  const targets = await dataset.targets(flags.targets);
  if (typeof flags.evaluate === "string") {
    await score(dataset, targets, flags.evaluate, flags);
    return;
  }
  const path = resultsName(flags.method, dataset.name, dataset.split, flags.csv);
  const { cases, instances } = await casesOf(dataset, targets, flags);
  if (cases.length === 0) throw new UsageError(`${folder}: there is nothing to align; check --targets and --masks.`);
  const { csv: _, ...files } = flags;
  const settings = { scale: METRES_PER_UNIT, ...flags.options };
  await alignBatch(cases, { ...files, options: settings }, new Output(files, [new BopResultsFile(path, instances)]));
  console.error(`results: ${path}`);
  if (flags.evaluate === true) await score(dataset, targets, path, flags);
}

/** A case for each instance of each target; and what they are, by their names. */
async function casesOf(dataset: BopDataset, targets: readonly BopTarget[], flags: BopFlags) {
  const detections = flags.masks === "gt" ? undefined : new Detections(flags.masks);
  const withPhoto = flags.image !== false;
  const modelOf = bopModelsIn(flags.models ?? (await dataset.models()), withPhoto);
  const info = await dataset.info().catch(() => new Map<number, BopModelInfo>());
  const instances = new Map<string, BopInstance>();
  const cases: CaseToDo[] = [];
  const add = (
    target: BopTarget,
    instance: number,
    detected: { score: number; seconds: number },
    maskOf: () => Promise<unknown>,
    truth: KnownPose | null,
  ) => {
    const { sceneId, imageId, objectId } = target;
    const name = `${targetKey(target)}-${instance}`;
    const { score: detectionScore, seconds: detectionSeconds } = detected;
    instances.set(name, { sceneId, imageId, objectId, detectionScore, detectionSeconds });
    const read = async (): Promise<CaseOnDisk> => {
      const image = await readBopImage(await dataset.scene(sceneId), bopId(imageId), withPhoto);
      const input = { ...image, mask: await maskOf(), mesh: await modelOf(objectId) } as AlignInput;
      return { name, input, files: {}, truth };
    };
    cases.push({ name, hasTruth: truth !== null, read });
  };
  for (const target of targets) {
    if (detections !== undefined) {
      for (const [i, { mask, ...detected }] of detections.of(target).entries())
        add(target, i, detected, async () => mask, null);
      continue;
    }
    const scene = await dataset.scene(target.sceneId);
    const image = bopId(target.imageId);
    const symmetry = symmetryOf(info.get(target.objectId));
    for (const place of mostVisible(scene, target)) {
      const entry = scene.truths.get(image)?.[place];
      const truth = entry === undefined ? null : { transform: fromBop(entry), symmetry };
      const maskOf = () => read("mask", bopMaskPath(scene, image, place));
      add(target, place, { score: 1, seconds: 0 }, maskOf, truth);
    }
  }
  return { cases, instances };
}

/** How the mesh is compared with the true pose. */
function symmetryOf(info: BopModelInfo | undefined): KnownPose["symmetry"] {
  return info === undefined || info.discrete.length + info.continuous.length === 0 ? "none" : "auto";
}

/** Scores a results file, and prints and writes the scores. */
async function score(dataset: BopDataset, targets: readonly BopTarget[], path: string, flags: BopFlags): Promise<void> {
  const status = new StatusLine(process.stderr);
  const evaluation = await evaluateBop(dataset, targets, readResults(path), (done) =>
    status.show(`evaluated ${done} of ${targets.length} targets`),
  ).finally(() => status.clear());
  const text = `${JSON.stringify(evaluation, null, 2)}\n`;
  if (flags.scores === "-") process.stdout.write(text);
  else if (flags.scores !== undefined) writeFileSync(flags.scores, text);
  const lines = [path, ...scoreLines(evaluation)].map((line) => `${line}\n`).join("");
  (flags.scores === "-" ? process.stderr : process.stdout).write(lines);
}

function scoreLines(evaluation: BopEvaluation): string[] {
  const { averageRecall, vsd, mssd, mspd, add, addS, targets, estimates, secondsPerImage } = evaluation;
  return pairs([
    ["poses", `${estimates} of ${targets} targets`],
    ["AR", fixed(averageRecall, 4)],
    ["AR VSD", fixed(vsd, 4)],
    ["AR MSSD", fixed(mssd, 4)],
    ["AR MSPD", fixed(mspd, 4)],
    ["ADD < 0.1 d", fixed(add, 4)],
    ["ADD-S < 0.1 d", fixed(addS, 4)],
    ["time per image", secondsPerImage === null ? "–" : `${fixed(secondsPerImage, 2)} s`],
  ]);
}
