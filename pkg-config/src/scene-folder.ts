/** Scenes on disk (Node only): scene folders, and images in the layout of BOP. */
import { readdir } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import { bopImageId, bopMaskPath, bopModels, bopName, openBopScene, readBopImage, readBopModel } from "./bop-folder.js";
import { type CaseSettings, caseFiles, fileNotFound } from "./case-files.js";
import { read, readMeshFile } from "./case-folder.js";
import { fromBop } from "./conventions/bop.js";
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import type { MeshFile } from "./input/types.js";
import type { SceneInput, SceneObjectInput } from "./scene/types.js";
import { withoutUndefined } from "./values.js";

/** A scene whose files have been read, but not decoded. */
export interface SceneOnDisk {
  name: string;
  input: SceneInput;
  /** The true pose of each object; `null` if unknown. */
  truths: (KnownPose | null)[];
}

/** How to read a scene. */
export interface SceneSettings extends CaseSettings {
  /** The folder of the models of a BOP image. */
  models?: string;
}

/**
 * Reads a scene: a folder with `depth.*`, optionally `camera.json`, and `objects/NAME/{mask.*, mesh.*, gt.json}`, or a scene of BOP
 * with `depth/`, `mask_visib/`, `scene_camera.json`, `scene_gt.json` and models.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names
 */
export async function readSceneFolder(folder: string, settings: SceneSettings = {}): Promise<SceneOnDisk> {
  const names = await namesIn(folder);
  return isBop(names) ? readBop(folder, settings) : readFolder(folder, names, settings);
}

const isBop = (names: readonly string[]) => names.includes("mask_visib") && names.includes("scene_gt.json");

/** The name of the image that would be read of a scene of BOP; `undefined` for other folders, and where none can be. */
export async function bopImageIn(folder: string, imageId: string | undefined): Promise<string | undefined> {
  try {
    return isBop(await namesIn(folder)) ? bopName(bopImageId(await openBopScene(folder), imageId)) : undefined;
  } catch {
    return undefined;
  }
}

async function readFolder(folder: string, names: string[], { models, ...settings }: SceneSettings) {
  const depth = await readOne("scene", folder, names, caseFiles.depth);
  const objects: SceneObjectInput[] = [];
  const truths: (KnownPose | null)[] = [];
  for (const name of (await namesIn(join(folder, "objects"))).sort()) {
    const own = join(folder, "objects", name);
    const files = await namesIn(own).catch(() => null);
    if (files === null) continue;
    const mask = await readOne(`objects/${name}`, own, files, caseFiles.mask);
    const meshName = oneOf(`objects/${name}`, own, files, caseFiles.mesh);
    const mesh = await readMeshFile(join(own, meshName));
    objects.push({ name, mask, mesh, ...resizeOf(settings) } as SceneObjectInput);
    truths.push(files.includes("gt.json") ? parsePoseFile("truth", await read("truth", join(own, "gt.json"))) : null);
  }
  const { resizeMask: _, image: withImage = true, ...view } = settings;
  const optional = async (part: "camera" | "image") => {
    const name = caseFiles[part].find((candidate) => names.includes(candidate));
    return name === undefined ? undefined : read(part, join(folder, name));
  };
  const [cameraFile, image] = [await optional("camera"), withImage ? await optional("image") : undefined];
  const input = withoutUndefined({ depth, cameraFile, objects, image, ...view }) as SceneInput;
  return { name: basename(resolve(folder)), input, truths };
}

/** Reads one image of a scene of BOP. */
async function readBop(folder: string, { models, imageId, ...settings }: SceneSettings) {
  const scene = await openBopScene(folder);
  const id = bopImageId(scene, imageId);
  const masks = await namesIn(join(folder, "mask_visib"));
  // The models of a data set are beside the scene, or beside the folder of its split.
  const places = ["models", "../models", "../../models", "../../models_eval"];
  const modelFolder = models ?? (await bopModels(folder, places));
  const meshes = new Map<number | undefined, MeshFile>();
  const objects: SceneObjectInput[] = [];
  const truths: (KnownPose | null)[] = [];
  for (const [i, entry] of (scene.truths.get(id) ?? []).entries()) {
    const maskPath = bopMaskPath(scene, id, i);
    // An object that the image does not show has no mask.
    if (!masks.includes(basename(maskPath))) continue;
    const mesh = meshes.get(entry.obj_id) ?? (await readBopModel(modelFolder, `${entry.obj_id}`));
    meshes.set(entry.obj_id, mesh);
    const mask = await read("mask", maskPath);
    objects.push({ name: `${entry.obj_id}-${i}`, mask, mesh, ...resizeOf(settings) } as SceneObjectInput);
    truths.push({ transform: fromBop(entry), symmetry: "auto" });
  }
  const { resizeMask: _, image: withImage = true, ...view } = settings;
  const input = { ...(await readBopImage(scene, id, withImage)), objects, ...view } as SceneInput;
  return { name: `${basename(resolve(folder))}/${bopName(id)}`, input, truths };
}

const resizeOf = ({ resizeMask }: CaseSettings) => (resizeMask === undefined ? {} : { resizeMask });

async function namesIn(folder: string): Promise<string[]> {
  return readdir(folder).catch((cause) => {
    throw fileNotFound("scene", `nothing to read at ${folder}`, "a folder with depth and objects", cause);
  });
}

function oneOf(argument: string, folder: string, names: readonly string[], wanted: readonly string[]): string {
  const name = wanted.find((candidate) => names.includes(candidate));
  if (name === undefined) throw fileNotFound(argument, `no such file in ${folder}`, wanted.join(" or "));
  return name;
}

const readOne = (argument: string, folder: string, names: readonly string[], wanted: readonly string[]) =>
  read(argument, join(folder, oneOf(argument, folder, names, wanted)));
