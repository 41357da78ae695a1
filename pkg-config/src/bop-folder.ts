/** Scenes in the layout of BOP on disk (Node only). */
import { readdir } from "node:fs/promises";
import { join } from "node:path";
import { fileNotFound } from "./case-files.js";
import { read, readMeshFile } from "./case-folder.js";
import type { BopPose } from "./conventions/bop.js";
import { isNumber, parsedJson } from "./formats/json.js";
import type { MeshFile } from "./input/types.js";
import { failure, invalidArgument } from "./values/error.js";
import { isRecord } from "./values/values.js";

/** A scene of BOP: what its JSON files say of all its images. */
export interface BopScene {
  folder: string;
  /** `scene_camera.json`. */
  cameraFile: Uint8Array;
  /** The poses in each image, by its id; empty where they are not public. */
  truths: ReadonlyMap<string, readonly BopPose[]>;
  /** The visible fraction of each pose, by the id of the image; empty without `scene_gt_info.json`. */
  visible: ReadonlyMap<string, readonly number[]>;
}

/** The ids of BOP in names of files. */
export const bopName = (id: string | number) => `${id}`.padStart(6, "0");

/** Ids have no leading zeros, unlike names of files. */
export const bopId = (id: string | number) => `${id}`.replace(/^0+(?=.)/, "");

/**
 * Reads the JSON files of a scene.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` without `scene_camera.json`, `CORRUPT_FILE`
 */
export async function openBopScene(folder: string): Promise<BopScene> {
  const names = await readdir(folder).catch((cause) => {
    throw fileNotFound("scene", `nothing to read at ${folder}`, "a folder with scene_camera.json and depth", cause);
  });
  const lists = async <T>(name: string, convert: (entry: Record<string, unknown>) => T) => {
    const json = names.includes(name) ? parsedJson(name, await read(name, join(folder, name))) : {};
    const images = new Map<string, T[]>();
    for (const [id, entries] of Object.entries(isRecord(json) ? json : {})) {
      if (!Array.isArray(entries) || !entries.every(isRecord)) {
        const remedy = "See the format of BOP datasets.";
        throw failure("CORRUPT_FILE", name, `an image ${id} without a list`, "a list of objects per image", remedy);
      }
      images.set(bopId(id), entries.map(convert));
    }
    return images;
  };
  return {
    folder,
    cameraFile: await read("camera", join(folder, "scene_camera.json")),
    // The poses are checked when they are used.
    truths: await lists("scene_gt.json", (entry) => entry as unknown as BopPose),
    visible: await lists("scene_gt_info.json", ({ visib_fract }) => (isNumber(visib_fract) ? visib_fract : 0)),
  };
}

/**
 * The id of an image: the given one, or the first of the scene.
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for an image without poses
 */
export function bopImageId({ truths }: BopScene, imageId: string | number | undefined): string {
  const ids = [...truths.keys()];
  const id = imageId === undefined ? ids[0] : ids.find((known) => known === bopId(imageId));
  if (id !== undefined) return id;
  throw invalidArgument("imageId", imageId, `one of ${ids.slice(0, 20).join(", ")}`, "Pass an id of the scene.");
}

/** The files of an image, as properties of an input. The photo is optional. */
export async function readBopImage({ folder, cameraFile }: BopScene, imageId: string, withPhoto: boolean) {
  const depth = await read("depth", join(folder, "depth", `${bopName(imageId)}.png`));
  const photos = withPhoto ? await readdir(join(folder, "rgb")).catch(() => []) : [];
  const photo = photos.find((name) => ["png", "jpg"].some((ending) => name === `${bopName(imageId)}.${ending}`));
  const image = photo === undefined ? {} : { image: await read("image", join(folder, "rgb", photo)) };
  return { depth, cameraFile, imageId, ...image };
}

/** The path of the mask of the visible part of an object, by its place in `scene_gt.json`. */
export const bopMaskPath = ({ folder }: BopScene, imageId: string, place: number) =>
  join(folder, "mask_visib", `${bopName(imageId)}_${bopName(place)}.png`);

/** Reads the model of an object, in millimetres. */
export const readBopModel = (models: string, objectId: number | string): Promise<MeshFile> =>
  readMeshFile(join(models, `obj_${bopName(objectId)}.ply`));

/**
 * The first folder of models there is.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND`
 */
export async function bopModels(folder: string, places: readonly string[]): Promise<string> {
  for (const place of places) {
    const found = await readdir(join(folder, place)).catch(() => null);
    if (found !== null) return join(folder, place);
  }
  throw fileNotFound("models", `no folder of models at ${folder}`, "models beside the scene, or --models");
}
