/** Scenes on disk (Node only): scene folders, and images in the layout of BOP. */
import { readdir } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import { type CaseSettings, caseFiles, fileNotFound, meshFile } from "./case-files.js";
import { read } from "./case-folder.js";
import { type BopPose, fromBop } from "./conventions/bop.js";
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import { invalidArgument } from "./error.js";
import { parsedJson } from "./formats/json.js";
import { formatsModule } from "./formats-module.js";
import type { MeshFile } from "./input/types.js";
import type { SceneInput, SceneObjectInput } from "./scene/types.js";
import { isRecord } from "./values.js";

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

const loadFormats = () => formatsModule.load();

/**
 * Reads a scene: a folder with `depth.*`, `camera.json` and `objects/NAME/{mask.*, mesh.*, gt.json}`, or a scene of BOP
 * with `depth/`, `mask_visib/`, `scene_camera.json`, `scene_gt.json` and models.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names
 */
export async function readSceneFolder(folder: string, settings: SceneSettings = {}): Promise<SceneOnDisk> {
  const names = await namesIn(folder);
  const isBop = names.includes("mask_visib") && names.includes("scene_gt.json");
  return isBop ? readBop(folder, settings) : readFolder(folder, names, settings);
}

async function readFolder(folder: string, names: string[], { models, ...settings }: SceneSettings) {
  const [depth, cameraFile] = await Promise.all(
    [caseFiles.depth, caseFiles.camera].map((files) => readOne("scene", folder, names, files)),
  );
  const objects: SceneObjectInput[] = [];
  const truths: (KnownPose | null)[] = [];
  for (const name of (await namesIn(join(folder, "objects"))).sort()) {
    const own = join(folder, "objects", name);
    const files = await namesIn(own).catch(() => null);
    if (files === null) continue;
    const mask = await readOne(`objects/${name}`, own, files, caseFiles.mask);
    const meshName = oneOf(`objects/${name}`, own, files, caseFiles.mesh);
    const mesh = await readMesh(own, meshName);
    objects.push({ name, mask, mesh, ...resizeOf(settings) } as SceneObjectInput);
    truths.push(files.includes("gt.json") ? parsePoseFile("truth", await read("truth", join(own, "gt.json"))) : null);
  }
  const { resizeMask: _, image: withImage = true, ...view } = settings;
  const photo = withImage ? caseFiles.image.find((name) => names.includes(name)) : undefined;
  const image = photo === undefined ? {} : { image: await read("image", join(folder, photo)) };
  const input = { depth, cameraFile, objects, ...image, ...view } as SceneInput;
  return { name: basename(resolve(folder)), input, truths };
}

/** Reads one image of a scene of BOP. */
async function readBop(folder: string, { models, imageId, ...settings }: SceneSettings) {
  const json = async (name: string) => parsedJson(name, await read(name, join(folder, name)));
  const truthsByImage = await json("scene_gt.json");
  const images = isRecord(truthsByImage) ? Object.keys(truthsByImage) : [];
  const short = (id: unknown) => `${id}`.replace(/^0+(?=.)/, "");
  const id = imageId === undefined ? images[0] : images.find((image) => short(image) === short(imageId));
  const entries: unknown = isRecord(truthsByImage) && id !== undefined ? truthsByImage[id] : undefined;
  if (id === undefined || !Array.isArray(entries) || !entries.every(isRecord)) {
    throw invalidArgument("imageId", imageId, `one of ${images.slice(0, 20).join(", ")}`, "Pass an id of the scene.");
  }
  const image = id.padStart(6, "0");
  const depth = await read("depth", join(folder, "depth", `${image}.png`));
  const cameraFile = await read("camera", join(folder, "scene_camera.json"));
  const masks = await namesIn(join(folder, "mask_visib"));
  const modelFolder = models ?? (await modelsNear(folder));
  const meshes = new Map<string, MeshFile>();
  const objects: SceneObjectInput[] = [];
  const truths: (KnownPose | null)[] = [];
  for (const [i, entry] of entries.entries()) {
    const maskName = `${image}_${`${i}`.padStart(6, "0")}.png`;
    // An object that the image does not show has no mask.
    if (!masks.includes(maskName)) continue;
    const model = `obj_${`${entry.obj_id}`.padStart(6, "0")}.ply`;
    const mesh = meshes.get(model) ?? (await readMesh(modelFolder, model));
    meshes.set(model, mesh);
    const mask = await read("mask", join(folder, "mask_visib", maskName));
    objects.push({ name: `${entry.obj_id}-${i}`, mask, mesh, ...resizeOf(settings) } as SceneObjectInput);
    truths.push({ transform: fromBop(entry as unknown as BopPose), symmetry: "auto" });
  }
  const { resizeMask: _, image: withImage = true, ...view } = settings;
  const photos = withImage ? await namesIn(join(folder, "rgb")).catch(() => []) : [];
  const photo = photos.find((name) => name === `${image}.png` || name === `${image}.jpg`);
  const bytes = photo === undefined ? {} : { image: await read("image", join(folder, "rgb", photo)) };
  const input = { depth, cameraFile, imageId: id, objects, ...bytes, ...view } as SceneInput;
  return { name: `${basename(resolve(folder))}/${image}`, input, truths };
}

/** The models of a data set: beside the scene, or beside the folder of its split. */
async function modelsNear(folder: string): Promise<string> {
  for (const place of ["models", "../models", "../../models", "../../models_eval"]) {
    const found = await namesIn(join(folder, place)).catch(() => null);
    if (found !== null) return join(folder, place);
  }
  throw fileNotFound("models", `no folder of models at ${folder}`, "models beside the scene, or --models");
}

const resizeOf = ({ resizeMask }: CaseSettings) => (resizeMask === undefined ? {} : { resizeMask });

async function namesIn(folder: string): Promise<string[]> {
  return readdir(folder).catch((cause) => {
    throw fileNotFound("scene", `nothing to read at ${folder}`, "a folder with depth, camera and objects", cause);
  });
}

function oneOf(argument: string, folder: string, names: readonly string[], wanted: readonly string[]): string {
  const name = wanted.find((candidate) => names.includes(candidate));
  if (name === undefined) throw fileNotFound(argument, `no such file in ${folder}`, wanted.join(" or "));
  return name;
}

const readOne = (argument: string, folder: string, names: readonly string[], wanted: readonly string[]) =>
  read(argument, join(folder, oneOf(argument, folder, names, wanted)));

async function readMesh(folder: string, name: string): Promise<MeshFile> {
  const bytes = await read("mesh", join(folder, name));
  return meshFile(name, bytes, loadFormats, (path) => read("mesh", join(folder, path)));
}
