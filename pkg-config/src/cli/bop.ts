/** `sim3align bop`: aligns the targets of a BOP dataset, and writes the results file of the leaderboard. */
import { basename, resolve } from "node:path";
import { BopDataset, type BopTarget, METRES_PER_UNIT, readBopModel, targetKey } from "../bop/dataset.js";
import { type BopInstance, BopResults, RESULTS_HEADER, readDetections } from "../bop/files.js";
import { fromBop } from "../conventions/bop.js";
import type { KnownPose } from "../conventions/pose-file.js";
import type { AlignInput } from "../index.js";
import { readMesh } from "../input/mesh.js";
import { fileReaders } from "../modules/readers.js";
import { readOncePerKey } from "../read-files.js";
import { type CaseToDo, caseJob, precise, shared } from "./align.js";
import type { Job } from "./batch.js";
import { absolutePath, textOf, UsageError } from "./files.js";
import type { Flags } from "./flags.js";
import type { OutputName, RunFiles } from "./run-files.js";
import { note } from "./terminal.js";

/** The options of `align` that apply to targets of known size. */
export const bopOptions = [...shared, ...precise].filter(({ name }) =>
  ["quality", "workBudget", "seed"].includes(name),
);

/**
 * The results file that is written: `METHOD_DATASET-SPLIT[_SUFFIX].csv`, as the leaderboard reads it.
 * @throws {@link UsageError} for names that would be read as other parts
 */
export function resultsFile([dataset = ""]: readonly string[], flags: Flags): [OutputName] {
  const { method = "", suffix, split = "" } = flags;
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

/** The job of a command line. */
export async function bopJob(args: readonly string[], flags: Flags, files: RunFiles): Promise<Job<CaseToDo>> {
  const [folder = ""] = args;
  const dataset = new BopDataset(folder, flags.split ?? "");
  const targets = await dataset.targets(flags.targets);
  const [file] = resultsFile(args, flags);
  const place = `${absolutePath(folder)}/${flags.split}#`;
  const { cases, instances } = await casesOf(dataset, targets, flags, place);
  if (cases.length === 0) throw new UsageError(`${folder}: there is nothing to align; check --targets and --masks.`);
  const results = new BopResults(instances);
  const end = () => files.write(file, results.text());
  return {
    flags,
    ...caseJob(cases, { ...flags, options: { scale: METRES_PER_UNIT, ...flags.options } }),
    folders: dataset.folders,
    isDeep: true,
    sinks: [{ add: (name, entry) => results.add(name, entry), end }],
    after: async () => note(`results: ${file.path}`),
  };
}

/** A case for each instance of each target, and the instances by the names of the cases. */
async function casesOf(dataset: BopDataset, targets: readonly BopTarget[], flags: Flags, folder: string) {
  const { masks = "gt" } = flags;
  const detections = masks === "gt" ? undefined : grouped(readDetections(textOf("--masks", masks)), targetKey);
  const withPhoto = flags.image !== false;
  const modelOf = bopModelsIn(flags.models ?? (await dataset.models()), withPhoto);
  const symmetric = await dataset.symmetricObjects();
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
    const symmetry: KnownPose["symmetry"] = symmetric.has(objectId) ? "auto" : "none";
    for (const place of scene.mostVisible(target, count)) {
      const entry = scene.posesIn(imageId)[place];
      const truth = entry === undefined ? null : { transform: fromBop(entry), symmetry };
      add(target, place, { score: 1, seconds: 0 }, () => scene.mask(imageId, place), truth);
    }
  }
  return { cases, instances };
}

/** The models in a folder by their ids, each read once: arrays in millimetres, with what the reader says. */
const bopModelsIn = (folder: string, withColors: boolean): ((objectId: number) => Promise<object>) =>
  readOncePerKey(async (objectId) => {
    const file = await readBopModel(folder, objectId);
    const { mesh, ...notes } = await readMesh(file, fileReaders, withColors);
    return { ...mesh, ...notes };
  });

/** The detections with the highest scores, in their order; of equal scores, those that come first. */
const best = <T extends { score: number }>(detections: readonly T[], count: number): T[] =>
  [...detections].sort((a, b) => b.score - a.score).slice(0, count);

/** Items by their keys, in their order. */
function grouped<T, K>(items: readonly T[], keyOf: (item: T) => K): Map<K, T[]> {
  const groups = new Map<K, T[]>();
  for (const item of items) {
    const key = keyOf(item);
    const group = groups.get(key);
    if (group === undefined) groups.set(key, [item]);
    else group.push(item);
  }
  return groups;
}
