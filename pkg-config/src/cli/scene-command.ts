/** `sim3align scene`: aligns the objects of scenes and prints what stands where. */
import { Command } from "commander";
import { read } from "../case-folder.js";
import { parsedJson } from "../formats/json.js";
import {
  type Aligner,
  type AlignInput,
  OPTIONS,
  type OptionRow,
  type PoseErrors,
  type SceneInput,
  type SceneOptions,
  type SceneResult,
} from "../index.js";
import { bopImageIn, readSceneFolder, type SceneOnDisk, type SceneSettings } from "../scene-folder.js";
import { withoutUndefined } from "../values/values.js";
import { errorsOf } from "./align-case.js";
import type { Done } from "./batch.js";
import { addBatchFlags, type BatchFlags, batchHelp } from "./batch-flags.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseSettings,
  conventionsHelp,
  depthKindHelp,
  statusHelp,
} from "./case-options.js";
import { depthRows } from "./depth-rows.js";
import { type FolderToDo, foldersToDo, sam3dKind, sceneKind } from "./folders.js";
import { isMetric, Lengths } from "./lengths.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { type Failure, failedLine, failureOf, failureText, type Outcome, ofInputJson, outcomeJson } from "./outcome.js";
import { Output } from "./output.js";
import { addPictureFlags, drawEntry, type PictureFlags } from "./pictures.js";
import { proportionsRows } from "./report.js";
import { type Live, runBatch } from "./run-batch.js";
import { addSceneFileFlags, checkSceneFiles, type SceneFileFlags, writeSceneFiles } from "./scene-files.js";
import type { Style } from "./style.js";
import { type Column, fixed, headings, pairs, tableLine } from "./table.js";

interface SceneFlags extends CaseFlags, PictureFlags, SceneFileFlags, BatchFlags, Readonly<Record<string, unknown>> {
  snap?: boolean;
  support?: string;
  models?: string;
  sam3d?: boolean;
}

/** The options of `align`, for every object; a first pose is that of one. */
const rows: readonly OptionRow[] = OPTIONS.align.filter(({ name }) => name !== "initial");

const help = `
A scene folder holds
  depth.npy or .png …                   as a case folder, see "sim3align align --help"; also camera.json and the photo
  objects/NAME/mask.png, .npy or .json  the mask of each object
  objects/NAME/mesh.glb, …              its mesh; textures are kept by --scene-glb
  objects/NAME/initial.json (optional)  a pose to start from, as gt.json: one candidate among those of the search
  objects/NAME/gt.json (optional)       its true pose
A scene in the layout of BOP (depth/, mask_visib/, scene_camera.json, scene_gt.json, and models in models/, ../models or
../../models) is one as well; --image-id selects the image.
With --sam3d, a folder is an output of SAM 3D Objects: pointmap.npy or depth.*, the photo, and for each object a mask, a GLB or
the PLY of its Gaussians, and pose.json { "rotation", "translation", "scale" }, in objects/NAME/ or with NAME in their names.
Frames are converted; its own placement is one candidate. Its point maps have no unit: pass --depth-kind metric if one has.
${conventionsHelp}
  The support is the plane n·x + d = 0 in the camera frame, metres; n points to the side of the objects.
${depthKindHelp}
  Files for simulators need metres.

Output
  A row per object: confidence, scale, what it rests on, gap, shared volume, silhouette IoU; with gt.json also the errors
  against it. With --proportions, its lengths in the proportions found are below.
  --json writes { "<scene>": { "objects": { "<object>": as a case of "align --json", with "contact" },
  "support": { "normal", "d", "confidence" } | null, "metrics", "warnings",
  "depthUnit", "cameraSource", "depthCalibration" } }; a scene that failed has { "error" }.
  --csv has a row per object, SCENE/OBJECT. --report, --overlay and --glb write pictures and posed meshes of each object, see "sim3align align --help".
  --scene-glb writes the scene of a single folder: nodes by name, materials and textures, the camera, and the support as
  ground, y up, in metres.
  --mjcf, --urdf and --usd write it for simulators, z up: bodies with mass and convex parts, the support as ground, the camera.
  What rests on the support or on another object is put at rest; what leans, hangs or stands on anything else is fixed.
  --no-rest keeps every pose as it was found; the files hold both.
${batchHelp(sceneKind)}

Examples
  sim3align scene scenes/desk
  sim3align scene scenes/* --json scenes.json
  sim3align scene 'scenes/**' --jsonl scenes.jsonl --csv scenes.csv --resume
  sim3align scene scenes/desk --scale 0.05,0.5
  sim3align scene scenes/desk --snap --scene-glb desk.glb
  sim3align scene scenes/desk --mjcf desk-mujoco --usd desk.usda
  sim3align scene --sam3d outputs/desk --scene-glb desk.glb
  sim3align scene scenes/desk --depth-kind affine-invariant-disparity
  sim3align scene scenes/* --report report
  sim3align scene bop/test/000048 --image-id 1 --json -
${statusHelp}`;

/** The command. */
export function sceneCommand(): Command {
  const command = addSceneFileFlags(addBatchFlags(new Command("scene"), sceneKind))
    .summary("align all objects of each scene, and what they stand on")
    .description("Aligns the objects of each scene together: one depth map, a mask and a mesh per object.")
    .option("--snap", "put objects exactly onto what they touch")
    .option("--support <auto|none|file>", 'what objects stand on: found, nothing, or a JSON file { "normal", "d" }')
    .option("--models <folder>", "the models of a BOP scene")
    .option("--sam3d", "the folders are outputs of SAM 3D Objects");
  addOptionFlags(addCaseOptions(addPictureFlags(command)).optionsGroup("Options of every object:"), rows);
  return command.addHelpText("after", help).action(run);
}

async function run(args: string[], flags: SceneFlags): Promise<void> {
  const kind = flags.sam3d ? sam3dKind : sceneKind;
  const scenes = await scenesIn(await foldersToDo(kind, args, flags.list), flags);
  checkSceneFiles(flags, scenes.length, hasLengths(flags));
  const support = await supportOf(flags.support);
  const settings: SceneSettings = withoutUndefined({
    ...caseSettings(flags),
    models: flags.models,
    sam3d: flags.sam3d,
  });
  const output = new Output(flags);
  await runBatch(scenes, flags, output, {
    run: (aligner, scene, live) => alignScene(aligner, scene, flags, { settings, support, style: output.style }, live),
    draw: (pictures, scene, entry, isResumed) =>
      drawEntry(pictures, scene.name, entry, isResumed, async () => {
        const onDisk = await readSceneFolder(scene.scene, settings);
        const inputs = new Map<string, AlignInput>();
        for (const [i, { name }] of onDisk.input.objects.entries()) {
          const input = inputOf(onDisk, i);
          if (input !== undefined) inputs.set(`${scene.name}/${name ?? i}`, input);
        }
        return inputs;
      }),
  });
}

/** Whether the flags make lengths metric. */
const hasLengths = ({ sam3d, depthKind = sam3d ? "scale-invariant" : "metric", knownExtent, scale }: SceneFlags) =>
  depthKind === "metric" || knownExtent !== undefined || typeof scale === "number";

/** A scene to align. */
interface SceneToDo extends Omit<FolderToDo, "folder"> {
  scene: string;
  folder?: string;
}

/** The scenes in folders. Images of one scene of BOP are scenes of their own, and have no files of their own. */
async function scenesIn(folders: readonly FolderToDo[], { imageId }: SceneFlags): Promise<SceneToDo[]> {
  const scenes: SceneToDo[] = [];
  for (const { name, path, folder } of folders) {
    const image = await bopImageIn(folder, imageId);
    const own = image === undefined ? { name, path, folder } : { name: `${name}/${image}`, path: `${path}#${image}` };
    scenes.push({ ...own, scene: folder });
  }
  return scenes;
}

/** Aligns a scene. Only errors that concern all scenes are thrown. */
async function alignScene(
  aligner: Aligner,
  key: SceneToDo,
  flags: SceneFlags,
  { settings, support, style }: { settings: SceneSettings; support: SceneInput["support"]; style: Style },
  live?: Live,
): Promise<Done> {
  const done = (entry: object, shown: readonly string[]): Done =>
    live === undefined ? { key, entry, rows: shown, remarks: [] } : { key, entry, rows: [], remarks: shown };
  try {
    const scene = await readSceneFolder(key.scene, settings);
    const options: SceneOptions = { ...givenOptions(flags, rows), ...withoutUndefined({ snap: flags.snap }) };
    // A scale that is given goes before the first poses of files.
    const objects = scene.input.objects.map((object) => ({ ...object, ...(options.scale && { initial: undefined }) }));
    const input = { ...scene.input, objects, support } as SceneInput;
    const onProgress = live?.progress;
    const result = await aligner.alignScene(input, withoutUndefined({ ...options, onProgress }));
    const errors = await Promise.all(
      result.objects.map((object, i) => {
        const own = inputOf(scene, i);
        if (object.error !== undefined || own === undefined) return null;
        return errorsOf(aligner, own, { ...object, ...ofInputJson(result) }, scene.truths[i]);
      }),
    );
    const outcomes = outcomesOf(result, errors);
    const written = await writeSceneFiles(scene, result, flags);
    return done(sceneJson(result, outcomes), [...lines(key.name, result, outcomes, errors), ...written]);
  } catch (error) {
    const failed = failureOf(key.name, error);
    return done(outcomeJson(failed), [failedLine(failed, style)]);
  }
}

async function supportOf(flag: string | undefined): Promise<SceneInput["support"]> {
  if (flag === undefined || flag === "auto") return "auto";
  if (flag === "none") return null;
  // The core checks the plane.
  return parsedJson("support", await read("support", flag)) as SceneInput["support"];
}

/** The input of one object. */
function inputOf({ input: scene }: SceneOnDisk, index: number): AlignInput | undefined {
  const { objects, labels: _, occluders: __, support: ___, ...view } = scene;
  const object = objects[index];
  if (object === undefined) return undefined;
  const { mask, mesh, resizeMask } = object;
  return { ...view, mask, mesh, ...withoutUndefined({ resizeMask }) } as AlignInput;
}

const outcomesOf = ({ objects }: SceneResult, errors: readonly (PoseErrors | null)[]): Outcome[] =>
  objects.map((object, i) => {
    const name = object.name ?? `${i}`;
    if (object.error !== undefined) return { name, error: object.error, file: undefined };
    return { name, alignment: object, errors: errors[i] ?? null };
  });

/** The JSON entry of a scene. */
function sceneJson(result: SceneResult, outcomes: readonly Outcome[]): object {
  const { objects, support, metrics, warnings } = result;
  const entries = outcomes.map((outcome, i) => {
    const object = objects[i];
    const contact = object === undefined || object.error !== undefined ? {} : { contact: object.contact };
    return [outcome.name, { ...outcomeJson(outcome), ...contact }];
  });
  return { objects: Object.fromEntries(entries), support, metrics, warnings, ...ofInputJson(result) };
}

const number = (heading: string): Column => ({ heading, isNumber: true, width: 8 });
const columns: Column[] = [
  { heading: "object", width: 20 },
  ...["conf.", "scale"].map(number),
  { heading: "rests on", width: 20 },
  ...["gap mm", "shared %", "IoU", "Δscale %", "Δrot °", "Δtrans %"].map(number),
];

function lines(
  name: string,
  result: SceneResult,
  outcomes: readonly Outcome[],
  errors: readonly (PoseErrors | null)[],
): string[] {
  const { objects, support, warnings } = result;
  const lengths = new Lengths(isMetric(result));
  const plane =
    support === null
      ? "no support"
      : `support n = ${support.normal.map((x) => fixed(x, 4)).join(" ")}, d = ${fixed(support.d, 4)} ${lengths.unit}`;
  const rows = objects.flatMap((object, i) => {
    const outcome = outcomes[i] as Outcome;
    if (object.error !== undefined || "error" in outcome) return [`failed ${failureText(outcome as Failure)}`];
    const { restsOn, gapM, sharedVolume } = object.contact;
    const below = typeof restsOn === "number" ? (outcomes[restsOn]?.name ?? `${restsOn}`) : (restsOn ?? "–");
    const error = errors[i];
    const cells = [
      outcome.name,
      fixed(object.confidence, 2),
      fixed(object.scale, 5),
      below,
      lengths.cell(gapM === null ? null : 1000 * gapM, 1),
      fixed(100 * sharedVolume, 1),
      fixed(object.metrics?.iou ?? null, 3),
      ...(error === null || error === undefined
        ? ["–", "–", "–"]
        : [
            fixed(100 * error.scaleError, 1),
            fixed(error.rotationErrorDeg, 1),
            fixed(100 * error.translationErrorRelative, 1),
          ]),
    ];
    return [tableLine(columns, cells), ...pairs(proportionsRows(object, lengths))];
  });
  const notes = warnings.map(({ code, message }) => `${code}: ${message}`);
  return [`${name}: ${plane}`, ...pairs(depthRows(result)), headings(columns), ...rows, ...notes];
}
