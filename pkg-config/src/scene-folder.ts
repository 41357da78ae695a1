/** Scenes on disk (Node only): scene folders, and images in the layout of BOP. */
import { readdir } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import { BopScene, bopModels, isBopScene, readBopModel } from "./bop/dataset.js";
import type { ReadCaseOptions } from "./case-files.js";
import { type FoundFiles, filesBelow, filesIn, namesInFolder } from "./case-folder.js";
import { fromBop } from "./conventions/bop.js";
import type { KnownPose } from "./conventions/pose-file.js";
import { readOncePerKey } from "./read-files.js";
import { sam3dFrom } from "./scene/sam3d-files.js";
import { type SceneCase, sceneFrom } from "./scene/scene-files.js";
import type { SceneInput, SceneObjectInput } from "./types/scene.js";
import { withoutUndefined } from "./values/validation.js";

/** A scene on disk. */
export interface SceneOnDisk extends Pick<SceneCase, "input" | "truths"> {
  name: string;
  /** Its files; `undefined` for a scene of BOP, whose folder has the files of other images. */
  found?: FoundFiles;
}

/** How to read a scene. */
export interface SceneSettings extends ReadCaseOptions {
  /** Whether the folder is an output of SAM 3D Objects. */
  sam3d?: boolean;
  /** The folder of the models of a BOP image. */
  models?: string;
}

/**
 * Reads a scene: a scene folder, the output of SAM 3D Objects, or a scene of BOP with `depth/`, `mask_visib/`, `scene_camera.json`, `scene_gt.json` and models.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readSceneFolder(folder: string, settings: SceneSettings = {}): Promise<SceneOnDisk> {
  const names = await namesInFolder("scene", folder, "a folder with depth and objects");
  return isBopScene(names) ? readBop(folder, settings) : readFolder(folder, settings);
}

/** The name of the image that would be read of a scene of BOP; `undefined` for other folders, and where none can be. */
export async function bopImageIn(folder: string, imageId: string | undefined): Promise<string | undefined> {
  try {
    if (!isBopScene(await readdir(folder))) return undefined;
    return BopScene.imageName((await BopScene.open(folder)).imageId(imageId));
  } catch {
    return undefined;
  }
}

/** The folder of the models of a scene of BOP: beside the scene, or beside the folder of its split. */
const modelPlaces = ["models", "../models", "../../models", "../../models_eval"];

/** The folders that are read of a scene of BOP. */
export const bopFolders = (scene: string) => [scene, ...modelPlaces.map((place) => join(scene, place))];

async function readFolder(folder: string, { models, sam3d, ...settings }: SceneSettings): Promise<SceneOnDisk> {
  const paths = await filesBelow(folder, "", sam3d ? LEVELS : 1);
  if (!sam3d) paths.push(...(await filesBelow(folder, "objects/", LEVELS)));
  const from = sam3d ? sam3dFrom : sceneFrom;
  const { input, truths, ...found } = await from(filesIn("scene", folder, paths), settings, folder);
  return { name: basename(resolve(folder)), input, truths, found: { folder, ...found } };
}

/** Depth of the folders that are searched for the files of a scene. */
const LEVELS = 4;

/** Reads one image of a scene of BOP. */
async function readBop(folder: string, { models, imageId, sam3d: _, ...settings }: SceneSettings) {
  const scene = await BopScene.open(folder);
  const id = scene.imageId(imageId);
  const modelFolder = models ?? (await bopModels(folder, modelPlaces));
  const modelOf = readOncePerKey((objectId: string) => readBopModel(modelFolder, objectId));
  const { resizeMask, maskIndex, image: withImage = true, ...view } = settings;
  const objects: SceneObjectInput[] = [];
  const truths: (KnownPose | null)[] = [];
  const poses = scene.posesIn(id);
  for (const place of await scene.shown(id)) {
    const entry = poses[place] as (typeof poses)[number];
    const mesh = await modelOf(`${entry.obj_id}`);
    const object = { name: `${entry.obj_id}-${place}`, mask: await scene.mask(id, place), mesh };
    objects.push({ ...object, ...withoutUndefined({ resizeMask, maskIndex }) } as SceneObjectInput);
    truths.push({ transform: fromBop(entry), symmetry: "auto" });
  }
  const input = { ...(await scene.image(id, withImage)), objects, ...view } as SceneInput;
  return { name: `${basename(resolve(folder))}/${BopScene.imageName(id)}`, input, truths };
}
