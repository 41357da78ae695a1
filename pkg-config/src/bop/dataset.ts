/** Datasets in the layout of BOP on disk (Node only): models, scenes with their images, and the targets of a split. */
import { readdir } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import { fileNotFound } from "../case-files.js";
import { namesInFolder, readMeshFile } from "../case-folder.js";
import type { BopPose } from "../conventions/bop.js";
import { read, readOncePerKey } from "../read-files.js";
import type { MeshFile } from "../types/inputs.js";
import { failure, invalidArgument } from "../values/error.js";
import { isNumber, parsedJson, shown } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { naturally } from "../values/order.js";

/** BOP's lengths are in millimetres. */
export const METRES_PER_UNIT = 0.001;

/** Ids in names of files have leading zeros. */
const padded = (id: string | number) => `${id}`.padStart(6, "0");
const plain = (id: string | number) => `${id}`.replace(/^0+(?=.)/, "");

/** The paths of the files of a dataset: those of a scene in its folder, the others in that of the dataset. */
const paths = {
  camera: "scene_camera.json",
  poses: "scene_gt.json",
  visible: "scene_gt_info.json",
  depth: (image: string) => join("depth", `${padded(image)}.png`),
  photos: "rgb",
  masks: "mask_visib",
  mask: (image: string, place: number) => join("mask_visib", `${padded(image)}_${padded(place)}.png`),
  scene: (split: string, scene: number) => join(split, padded(scene)),
  model: (object: string | number) => `obj_${padded(object)}.ply`,
  info: "models_info.json",
  /** The targets of test splits. */
  targets: "test_targets_bop19.json",
};

const remedy = "See the format of BOP datasets.";

/** Without a file of targets, objects are targets whose visible fraction is at least this. */
const LEAST_VISIBLE = 0.1;

/** An object of an image, and how many of it are to be found there. */
export interface BopTarget {
  sceneId: number;
  imageId: number;
  objectId: number;
  count: number;
}

/** An object of an image. */
export type BopPlace = Omit<BopTarget, "count">;

/** The image of a target or of a result, as a key. */
export const imageKey = ({ sceneId, imageId }: Pick<BopTarget, "sceneId" | "imageId">) => `${sceneId}/${imageId}`;

/** The object and the image of a target, of a detection or of a result, as a key. */
export const targetKey = (target: BopPlace) => `${imageKey(target)}/${target.objectId}`;

/** Whether a folder with these names is a scene of BOP. */
export const isBopScene = (names: readonly string[]) => names.includes(paths.masks) && names.includes(paths.poses);

/** A scene: its JSON files, and the files of each image. */
export class BopScene {
  private constructor(
    readonly folder: string,
    readonly cameraFile: Uint8Array,
    /** The poses in each image, by its id; empty where they are not public. They are checked when they are used. */
    readonly truths: ReadonlyMap<string, readonly BopPose[]>,
    /** The visible fraction of each pose, by the id of the image; empty where it is unknown. */
    readonly visible: ReadonlyMap<string, readonly number[]>,
  ) {}

  /** @throws {@link Sim3AlignError} `FILE_NOT_FOUND` without `scene_camera.json`, `CORRUPT_FILE` */
  static async open(folder: string): Promise<BopScene> {
    const names = await namesInFolder("scene", folder, "a folder with scene_camera.json and depth");
    const lists = async <T>(name: string, convert: (entry: Record<string, unknown>) => T) => {
      const json = names.includes(name) ? parsedJson(name, await read(name, join(folder, name))) : {};
      const images = new Map<string, T[]>();
      for (const [id, entries] of Object.entries(isRecord(json) ? json : {})) {
        if (!Array.isArray(entries) || !entries.every(isRecord))
          throw failure("CORRUPT_FILE", name, `an image ${id} without a list`, "a list of objects per image", remedy);
        images.set(plain(id), entries.map(convert));
      }
      return images;
    };
    return new BopScene(
      folder,
      await read("camera", join(folder, paths.camera)),
      await lists(paths.poses, (entry) => entry as unknown as BopPose),
      await lists(paths.visible, ({ visib_fract }) => (isNumber(visib_fract) ? visib_fract : 0)),
    );
  }

  /**
   * The id of an image: the given one, or the first of the scene.
   * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for an image without poses
   */
  imageId(wanted: string | number | undefined): string {
    const ids = [...this.truths.keys()];
    const id = wanted === undefined ? ids[0] : ids.find((known) => known === plain(wanted));
    if (id !== undefined) return id;
    throw invalidArgument("imageId", wanted, `one of ${ids.slice(0, 20).join(", ")}`, "Pass an id of the scene.");
  }

  /** The name of an image: that of its files. */
  static imageName = padded;

  /** The poses in an image, in the order of its masks. */
  posesIn(image: string | number): readonly BopPose[] {
    return this.truths.get(plain(image)) ?? [];
  }

  #visibleFraction(image: string | number, place: number): number {
    return this.visible.get(plain(image))?.[place] ?? 1;
  }

  /** The files of an image, as properties of an input. The photo is optional. */
  async image(id: string | number, withPhoto: boolean) {
    const imageId = plain(id);
    const depth = await read("depth", join(this.folder, paths.depth(imageId)));
    const photos = withPhoto ? await readdir(join(this.folder, paths.photos)).catch(() => []) : [];
    const photo = photos.find((name) => ["png", "jpg"].some((ending) => name === `${padded(imageId)}.${ending}`));
    const image = photo === undefined ? {} : { image: await read("image", join(this.folder, paths.photos, photo)) };
    return { depth, cameraFile: this.cameraFile, imageId, ...image };
  }

  /** The mask of the visible part of an object, by its place among the poses. */
  mask(image: string | number, place: number): Promise<Uint8Array> {
    return read("mask", join(this.folder, paths.mask(plain(image), place)));
  }

  /** The places of the objects that an image shows: those with a mask. */
  async shown(image: string): Promise<number[]> {
    const masks = await readdir(join(this.folder, paths.masks));
    const places = [...this.posesIn(image).keys()];
    return places.filter((place) => masks.includes(basename(paths.mask(image, place))));
  }

  /** The places of an object's most visible instances in an image, the most visible one first. */
  mostVisible({ imageId, objectId }: BopPlace, count = Number.POSITIVE_INFINITY): number[] {
    const fraction = (place: number) => this.#visibleFraction(imageId, place);
    return [...this.posesIn(imageId).entries()]
      .flatMap(([place, { obj_id }]) => (obj_id === objectId ? [place] : []))
      .sort((a, b) => fraction(b) - fraction(a) || a - b)
      .slice(0, count);
  }

  /** The objects of all images that are visible enough, by image. */
  visibleTargets(sceneId: number): BopTarget[] {
    const targets: BopTarget[] = [];
    for (const [image, poses] of this.truths) {
      const ids = poses.flatMap(({ obj_id = 0 }, place) =>
        this.#visibleFraction(image, place) >= LEAST_VISIBLE ? [obj_id] : [],
      );
      for (const objectId of [...new Set(ids)].sort((a, b) => a - b)) {
        const count = ids.filter((id) => id === objectId).length;
        targets.push({ sceneId, imageId: Number(image), objectId, count });
      }
    }
    return targets;
  }
}

/** Reads the model of an object, in millimetres. */
export const readBopModel = (models: string, objectId: number | string): Promise<MeshFile> =>
  readMeshFile(join(models, paths.model(objectId)));

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

/** A split of a dataset. */
export class BopDataset {
  /** The names of the dataset and of the split: those of their folders. */
  readonly name: string;
  readonly split: string;
  readonly #folder: string;
  /** A scene, which is read once. */
  readonly scene: (sceneId: number) => Promise<BopScene>;

  constructor(folder: string, split: string) {
    this.name = basename(resolve(folder));
    this.split = split;
    this.#folder = folder;
    this.scene = readOncePerKey((sceneId) => BopScene.open(join(folder, paths.scene(split, sceneId))));
  }

  /** The folders that may be read. */
  get folders(): string[] {
    return [this.split, "models", "models_cad", "models_eval"].map((name) => join(this.#folder, name));
  }

  /** The folder of the models that are aligned. */
  models(): Promise<string> {
    return bopModels(this.#folder, ["models", "models_cad", "models_eval"]);
  }

  /**
   * The targets in a file; without one, those of the dataset if the split is a test split and has some, or else all objects
   * that are visible enough.
   * @throws {@link Sim3AlignError} `FILE_NOT_FOUND`, `CORRUPT_FILE`
   */
  async targets(file?: string): Promise<BopTarget[]> {
    const folder = join(this.#folder, this.split);
    const names = await namesInFolder("split", folder, "the folder of a split, such as test");
    const isTest = this.split.split("_")[0] === "test";
    const hasTargets = isTest && (await readdir(this.#folder)).includes(paths.targets);
    const path = file ?? (hasTargets ? join(this.#folder, paths.targets) : undefined);
    if (path === undefined) {
      const ids = names.filter((name) => /^\d+$/.test(name)).sort(naturally);
      const scenes = ids.map(async (id) => (await this.scene(Number(id))).visibleTargets(Number(id)));
      return (await Promise.all(scenes)).flat();
    }
    const entries = parsedJson("targets", await read("targets", path));
    if (!Array.isArray(entries)) throw noTarget(entries);
    return entries.map(targetOf);
  }

  /** The ids of the objects that `models_info.json` calls symmetric; none without that file. */
  async symmetricObjects(): Promise<ReadonlySet<number>> {
    const models = await bopModels(this.#folder, ["models_eval", "models"]).catch(() => null);
    const file = models && (await read(paths.info, join(models, paths.info)).catch(() => null));
    const info = file && parsedJson(paths.info, file);
    const entries = isRecord(info) ? Object.entries(info) : [];
    const symmetric = entries.filter(([, object]) => {
      const { symmetries_discrete, symmetries_continuous } = isRecord(object) ? object : {};
      return [symmetries_discrete, symmetries_continuous].some((list) => Array.isArray(list) && list.length > 0);
    });
    return new Set(symmetric.map(([id]) => Number(id)));
  }
}

function targetOf(entry: unknown): BopTarget {
  const { scene_id, im_id, obj_id, inst_count } = isRecord(entry) ? entry : {};
  const ids = [scene_id, im_id, obj_id, inst_count];
  if (!ids.every((id) => Number.isSafeInteger(id) && (id as number) >= 0)) throw noTarget(entry);
  const [sceneId, imageId, objectId, count] = ids as [number, number, number, number];
  return { sceneId, imageId, objectId, count };
}

function noTarget(found: unknown) {
  const expected = "a list of { scene_id, im_id, obj_id, inst_count }";
  const advice = "Pass the targets of localization, such as test_targets_bop19.json.";
  return failure("CORRUPT_FILE", "targets", shown(found), expected, advice);
}
