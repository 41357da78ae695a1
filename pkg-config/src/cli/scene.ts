/** `sim3align scene`: aligns the objects of scenes. */
import { join } from "node:path";
import { type Aligner, type AlignInput, OPTIONS, type SceneInput, type SceneOptions } from "../index.js";
import { read } from "../read-files.js";
import { bopFolders, bopImageIn, readSceneFolder, type SceneSettings } from "../scene-folder.js";
import { parsedJson } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { withoutUndefined } from "../values/validation.js";
import { errorsOf } from "./align.js";
import { type CaseRun, failedLines, type Job } from "./batch.js";
import { depthRows, proportionsRows, warningLine } from "./details.js";
import { type Entry, isMetric, rowOf, type SceneEntry, sceneEntry, warningsOf, withFiles } from "./entry.js";
import { writeSceneFiles } from "./exports.js";
import { isFile, UsageError } from "./files.js";
import { caseSettings, type Flags, filesOf, sceneFileFlags } from "./flags.js";
import { type FolderToDo, foldersToDo, sam3dKind, sceneKind } from "./folders.js";
import { optionValues } from "./option-flags.js";
import { cellOf, fixed } from "./row.js";
import type { RunFiles } from "./run-files.js";
import { headings, Lengths, numeric, pairs, tableLine } from "./table.js";
import { Style } from "./terminal.js";

/** A scene to align. */
interface SceneToDo extends Omit<FolderToDo, "folder"> {
  scene: string;
  folder?: string;
}

/** The job of a command line. */
export async function sceneJob(args: readonly string[], flags: Flags, files: RunFiles): Promise<Job<SceneToDo>> {
  const { models, sam3d } = flags;
  const tasks = await scenesIn(await foldersToDo(sam3d ? sam3dKind : sceneKind, args, flags.list), flags.imageId);
  checkSceneFiles(flags, tasks.length);
  if (models !== undefined && tasks.every(({ folder }) => folder !== undefined))
    throw new UsageError("--models needs a scene of BOP: without one, it does nothing.");
  const support = await supportOf(flags.support);
  const settings: SceneSettings = withoutUndefined({ ...caseSettings(flags), models, sam3d });
  return {
    tasks,
    folders: tasks.flatMap(({ scene, folder }) => (folder === undefined ? bopFolders(scene) : [scene])),
    isDeep: sam3d === true || tasks.some(({ folder }) => folder === undefined),
    run: (aligner, task, caseRun) => alignScene(aligner, task, flags, settings, support, caseRun, files),
    // The files of a whole scene are made with its result only.
    isComplete: () => sceneOutputs(flags).every(({ path, holds }) => isFile(join(path, holds?.at(-1) ?? ""))),
    async inputs({ name, scene }) {
      const { input } = await readSceneFolder(scene, settings);
      return new Map(input.objects.map((object, i) => [`${name}/${object.name ?? i}`, inputOf(input, object)]));
    },
  };
}

const sceneOutputs = (flags: Flags) => filesOf(sceneFileFlags, flags, "writes");

/** The scenes in folders. Images of one scene of BOP are scenes of their own, and have no files of their own. */
async function scenesIn(folders: readonly FolderToDo[], imageId: string | undefined): Promise<SceneToDo[]> {
  const scenes: SceneToDo[] = [];
  for (const { name, path, folder } of folders) {
    const image = await bopImageIn(folder, imageId);
    const own = image === undefined ? { name, path, folder } : { name: `${name}/${image}`, path: `${path}#${image}` };
    scenes.push({ ...own, scene: folder });
  }
  return scenes;
}

/** @throws {@link UsageError} for files of a single scene, if there are several, and for files that need metres */
function checkSceneFiles(flags: Flags, scenes: number): void {
  const { sam3d, depthKind = sam3d ? "scale-invariant" : "metric", knownExtent, scale } = flags;
  const isMetric = depthKind === "metric" || knownExtent !== undefined || typeof scale === "number";
  for (const { flag } of sceneOutputs(flags)) {
    if (flag !== "--scene-glb" && !isMetric)
      throw new UsageError(
        `${flag} needs metres, which depth of this kind has not: pass --known-extent, or a number as --scale; or --depth-kind metric, if it is in metres.`,
      );
    if (scenes > 1) throw new UsageError(`${flag} takes a single scene.`);
  }
}

async function alignScene(
  aligner: Aligner,
  task: SceneToDo,
  flags: Flags,
  settings: SceneSettings,
  support: SceneInput["support"],
  caseRun: CaseRun,
  files: RunFiles,
): Promise<Entry> {
  const scene = await readSceneFolder(task.scene, settings);
  caseRun.found = scene.found;
  const options: SceneOptions = optionValues(flags, OPTIONS.alignScene);
  // A scale that is given goes before the first poses of files.
  const objects = scene.input.objects.map((object) => ({ ...object, ...(options.scale && { initial: undefined }) }));
  const input = { ...scene.input, objects, support } as SceneInput;
  const result = await aligner.alignScene(input, withoutUndefined({ ...options, onProgress: caseRun.onProgress }));
  const { depthUnit, depthCalibration } = result;
  const depth = withoutUndefined({ depthUnit, depthCalibration });
  const errors = result.objects.map((object, i) => {
    const own = scene.input.objects[i];
    if (object.error !== undefined || own === undefined) return null;
    return errorsOf(aligner, inputOf(scene.input, own), { ...object, ...depth }, scene.truths[i]);
  });
  const entry = withFiles(sceneEntry(result, await Promise.all(errors)), scene.found);
  caseRun.print(...linesOf(task.name, entry));
  await caseRun.make(async () => caseRun.print(...(await writeSceneFiles(scene, result, flags, files))));
  return entry;
}

async function supportOf(flag: string | undefined): Promise<SceneInput["support"]> {
  if (flag === undefined || flag === "auto") return "auto";
  if (flag === "none") return null;
  const plane = parsedJson("support", await read("support", flag));
  const { normal, d } = isRecord(plane) ? plane : {};
  const isPlane = Array.isArray(normal) && normal.length === 3 && [...normal, d].every(Number.isFinite);
  if (isPlane && normal.some((x) => x !== 0)) return plane as unknown as SceneInput["support"];
  throw new UsageError(
    `--support ${flag}: found ${JSON.stringify(plane).slice(0, 80)}, expected a plane { "normal": [x, y, z], "d": metres }.`,
  );
}

/** The input of one object. */
function inputOf(scene: SceneInput, { mask, mesh, resizeMask, maskIndex }: SceneInput["objects"][number]): AlignInput {
  const { objects: _, labels: __, occluders: ___, support: ____, ...view } = scene;
  return { ...view, mask, mesh, ...withoutUndefined({ resizeMask, maskIndex }) } as AlignInput;
}

const columns = [
  { heading: "object", width: 20 },
  ...["conf.", "scale"].map((heading) => numeric(heading, 8)),
  { heading: "rests on", width: 20 },
  ...["gap mm", "shared %", "IoU", "Δscale %", "Δrot °", "Δtrans %"].map((heading) => numeric(heading, 8)),
];

/** A table of the objects, in the order of their indices. */
function linesOf(name: string, entry: SceneEntry): string[] {
  const { objects, support, warnings } = entry;
  const names = objects.map((object, i) => object.name ?? `${i}`);
  const lengths = new Lengths(isMetric(entry));
  const plane =
    support === null
      ? "no support"
      : `support n = ${support.normal.map((x) => fixed(x, 4)).join(" ")}, d = ${fixed(support.d, 4)} ${lengths.unit}`;
  const plain = new Style({ isTTY: false });
  const rows = objects.flatMap((own, i) => {
    const object = names[i] as string;
    if (own.error !== undefined) return failedLines(object, own, plain);
    const { contact, scale } = own;
    const { restsOn, gapM, sharedVolume } = contact;
    const row = rowOf(own);
    const cells = [
      ...[object, cellOf(row, "confidence"), fixed(scale, 5)],
      typeof restsOn === "number" ? (names[restsOn] ?? `${restsOn}`) : (restsOn ?? "–"),
      fixed(gapM === null || !lengths.isMetric ? null : 1000 * gapM, 1),
      fixed(100 * sharedVolume, 1),
      ...(["iou", "scaleError", "rotationErrorDeg", "translationErrorRelative"] as const).map((fact) =>
        cellOf(row, fact),
      ),
    ];
    return [tableLine(columns, cells), ...pairs(proportionsRows(own, lengths))];
  });
  const notes = warningsOf({ warnings }).map((warning) => warningLine(warning, plain));
  return [`${name}: ${plane}`, ...pairs(depthRows(entry)), headings(columns), ...rows, ...notes];
}
