/** `sim3align bop`: aligns the targets of a BOP dataset, writes the results file of the leaderboard, and scores it. */
import { basename, resolve } from "node:path";
import { BopDataset, type BopModelInfo, type BopTarget, METRES_PER_UNIT, targetKey } from "../bop/dataset.js";
import { type BopInstance, BopResults, RESULTS_HEADER, readDetections, readResults } from "../bop/files.js";
import { type BopEvaluation, best, bopModelsIn, evaluateBop, grouped } from "../bop/scores.js";
import { fromBop } from "../conventions/bop.js";
import type { KnownPose } from "../conventions/pose-file.js";
import type { AlignInput } from "../index.js";
import { type CaseToDo, caseJob, precise, shared } from "./align.js";
import type { Job } from "./batch.js";
import { absolutePath, textOf, UsageError } from "./files.js";
import type { Flags } from "./flags.js";
import { StatusLine } from "./progress.js";
import { isResults } from "./result-files.js";
import { fixed } from "./row.js";
import type { OutputName, RunFiles } from "./run-files.js";
import { type Pair, pairs } from "./table.js";
import { note } from "./terminal.js";

/** The options of `align` that apply to targets of known size. */
export const bopOptions = [...shared, ...precise].filter(({ name }) =>
  ["quality", "workBudget", "seed"].includes(name),
);

/**
 * The results file that is written: `METHOD_DATASET-SPLIT[_SUFFIX].csv`, as the leaderboard reads it.
 * @throws {@link UsageError} for names that would be read as other parts
 */
export function resultsFile([dataset = ""]: readonly string[], flags: Flags): OutputName[] {
  const { method = "", suffix, split = "", evaluate } = flags;
  if (typeof evaluate === "string") return [];
  for (const [flag, part] of Object.entries({ method, suffix })) {
    if (part !== undefined && !/^[A-Za-z0-9-]+$/.test(part))
      throw new UsageError(
        `--${flag} ${part}: only letters, digits and "-" can be part of the name of a results file.`,
      );
  }
  const name = `${method}_${basename(resolve(dataset))}-${split.replaceAll("_", "-")}`;
  const isOwn = (beginning: string) => beginning.startsWith(`${RESULTS_HEADER}\n`);
  return [{ flag: "the results file", path: `${name}${suffix === undefined ? "" : `_${suffix}`}.csv`, isOwn }];
}

/** Whether a file begins like the output of --scores or of --json. */
export const isScores = (beginning: string) => beginning.startsWith('{\n  "averageRecall":') || isResults(beginning);

/** The job of a command line; without cases if `--evaluate` names a file, which is only scored. */
export async function bopJob(args: readonly string[], flags: Flags, files: RunFiles): Promise<Job<CaseToDo>> {
  const [folder = ""] = args;
  const dataset = new BopDataset(folder, flags.split ?? "");
  const targets = await dataset.targets(flags.targets);
  const [file] = resultsFile(args, flags);
  const whole = { folders: dataset.folders, isDeep: true };
  const scored = (path: string) => score(dataset, targets, path, flags, files);
  if (file === undefined) return { ...caseJob([], flags), ...whole, after: () => scored(String(flags.evaluate)) };
  const place = `${absolutePath(folder)}/${flags.split}#`;
  const { cases, instances } = await casesOf(dataset, targets, flags, place);
  if (cases.length === 0) throw new UsageError(`${folder}: there is nothing to align; check --targets and --masks.`);
  const results = new BopResults(instances);
  const end = () => files.write(file, results.text());
  return {
    flags,
    ...caseJob(cases, { ...flags, options: { scale: METRES_PER_UNIT, ...flags.options } }),
    ...whole,
    sinks: [{ add: (name, entry) => results.add(name, entry), end }],
    async after() {
      note(`results: ${file.path}`);
      if (flags.evaluate === true) await scored(file.path);
    },
  };
}

/** A case for each instance of each target, and the instances by the names of the cases. */
async function casesOf(dataset: BopDataset, targets: readonly BopTarget[], flags: Flags, folder: string) {
  const { masks = "gt" } = flags;
  const detections = masks === "gt" ? undefined : grouped(readDetections(textOf("--masks", masks)), targetKey);
  const withPhoto = flags.image !== false;
  const modelOf = bopModelsIn(flags.models ?? (await dataset.models()), withPhoto);
  const info = await dataset.info().catch(() => new Map<number, BopModelInfo>());
  const instances = new Map<string, BopInstance>();
  const cases: CaseToDo[] = [];
  const add = (
    target: BopTarget,
    instance: number,
    detected: { score: number; seconds: number },
    maskOf: () => unknown,
    truth: KnownPose | null,
  ) => {
    const { count: _, ...place } = target;
    const name = `${targetKey(target)}-${instance}`;
    instances.set(name, { ...place, detectionScore: detected.score, detectionSeconds: detected.seconds });
    const read = async () => {
      const image = await (await dataset.scene(place.sceneId)).image(place.imageId, withPhoto);
      const input = { ...image, mask: await maskOf(), mesh: await modelOf(place.objectId) } as AlignInput;
      return { input, truth };
    };
    cases.push({ name, path: `${folder}${name}`, hasTruth: truth !== null, read });
  };
  for (const target of targets) {
    const { imageId, objectId, count } = target;
    if (detections !== undefined) {
      const chosen = best(detections.get(targetKey(target)) ?? [], count);
      for (const [i, detection] of chosen.entries()) add(target, i, detection, () => detection.mask, null);
      continue;
    }
    const scene = await dataset.scene(target.sceneId);
    const symmetry = symmetryOf(info.get(objectId));
    for (const place of scene.mostVisible(target, count)) {
      const entry = scene.posesIn(imageId)[place];
      const truth = entry === undefined ? null : { transform: fromBop(entry), symmetry };
      add(target, place, { score: 1, seconds: 0 }, () => scene.mask(imageId, place), truth);
    }
  }
  return { cases, instances };
}

/** The symmetry with which the true pose is compared. */
function symmetryOf(info: BopModelInfo | undefined): KnownPose["symmetry"] {
  return info === undefined || info.discrete.length + info.continuous.length === 0 ? "none" : "auto";
}

/** Scores a results file, and prints and writes the scores. */
async function score(
  dataset: BopDataset,
  targets: readonly BopTarget[],
  path: string,
  flags: Flags,
  files: RunFiles,
): Promise<void> {
  const status = new StatusLine(process.stderr);
  const results = readResults(textOf("--evaluate", path));
  const evaluation = await evaluateBop(dataset, targets, results, (done) =>
    status.show(`evaluated ${done} of ${targets.length} targets`),
  ).finally(() => status.clear());
  if (flags.scores !== undefined)
    files.write({ flag: "--scores", path: flags.scores, isOwn: isScores }, `${JSON.stringify(evaluation, null, 2)}\n`);
  const lines = [path, ...scoreLines(evaluation)].map((line) => `${line}\n`).join("");
  (flags.scores === "-" ? process.stderr : process.stdout).write(lines);
}

function scoreLines(evaluation: BopEvaluation): string[] {
  const { averageRecall, vsd, mssd, mspd, add, addS, targets, estimates, secondsPerImage } = evaluation;
  const recalls = { AR: averageRecall, "AR VSD": vsd, "AR MSSD": mssd, "AR MSPD": mspd };
  const shares = { ...recalls, "ADD < 0.1 d": add, "ADD-S < 0.1 d": addS };
  return pairs([
    ["poses", `${estimates} of ${targets} targets`],
    ...Object.entries(shares).map(([name, share]): Pair => [name, fixed(share, 4)]),
    ["time per image", secondsPerImage === null ? "–" : `${fixed(secondsPerImage, 2)} s`],
  ]);
}
