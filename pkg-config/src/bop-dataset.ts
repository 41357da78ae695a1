/** Datasets in the layout of BOP on disk (Node only): models, scenes and targets of a split. */

import { readdir } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import { type BopScene, bopId, bopModels, bopName, openBopScene } from "./bop-folder.js";
import { fileNotFound } from "./case-files.js";
import { read } from "./case-folder.js";
import { isNumber, numbersIn, parsedJson, shown } from "./formats/json.js";
import { failure } from "./values/error.js";
import { isRecord, oncePerKey } from "./values/values.js";

/** The file of targets that a split has by default. */
const TARGETS = "test_targets_bop19.json";

/** Without a file of targets, objects are targets whose visible fraction is at least this. */
const LEAST_VISIBLE = 0.1;

/** An object of an image, and how many of it are to be found there. */
export interface BopTarget {
  sceneId: number;
  imageId: number;
  objectId: number;
  count: number;
}

/** The image of a target or of a result, as a key. */
export const imageKey = ({ sceneId, imageId }: Pick<BopTarget, "sceneId" | "imageId">) => `${sceneId}/${imageId}`;

/** The object and the image of a target, of a detection or of a result, as a key. */
export const targetKey = (target: Omit<BopTarget, "count">) => `${imageKey(target)}/${target.objectId}`;

/** What `models_info.json` says, in millimetres. */
export interface BopModelInfo {
  diameterMm: number;
  /** Discrete symmetries: 16 numbers each, row by row. */
  discrete: Float64Array;
  /** Axes of revolution: direction and a point on the axis, six numbers each. */
  continuous: Float64Array;
}

/** A split of a dataset. */
export class BopDataset {
  /** The name of the dataset: that of its folder. */
  readonly name: string;
  /** The name of the split: that of its folder. */
  readonly split: string;
  readonly #folder: string;
  /** A scene, which is read once. */
  readonly scene: (sceneId: number) => Promise<BopScene>;

  constructor(folder: string, split: string) {
    this.name = basename(resolve(folder));
    this.split = split;
    this.#folder = folder;
    this.scene = oncePerKey((sceneId) => openBopScene(join(folder, split, bopName(sceneId))));
  }

  /** The folder of the models that are aligned. */
  models(): Promise<string> {
    return bopModels(this.#folder, ["models", "models_cad", "models_eval"]);
  }

  /** The folder of the models that errors are measured with. */
  modelsOfErrors(): Promise<string> {
    return bopModels(this.#folder, ["models_eval", "models"]);
  }

  /**
   * The targets in a file; without one, those of the dataset if the split is a test split and has some, or else all objects
   * that are visible enough.
   * @throws {@link Sim3AlignError} `FILE_NOT_FOUND`, `CORRUPT_FILE`
   */
  async targets(file?: string): Promise<BopTarget[]> {
    const names = await readdir(join(this.#folder, this.split)).catch((cause) => {
      const expected = "the folder of a split, such as test";
      throw fileNotFound("split", `nothing to read at ${join(this.#folder, this.split)}`, expected, cause);
    });
    const isTest = this.split.split("_")[0] === "test";
    const hasTargets = isTest && (await readdir(this.#folder)).includes(TARGETS);
    const path = file ?? (hasTargets ? join(this.#folder, TARGETS) : undefined);
    if (path === undefined) return this.#visible(names.filter((name) => /^\d+$/.test(name)).sort());
    const entries = parsedJson("targets", await read("targets", path));
    if (!Array.isArray(entries)) throw noTarget(shown(entries));
    return entries.map(targetOf);
  }

  /** What `models_info.json` says, by the id of the object. */
  async info(): Promise<ReadonlyMap<number, BopModelInfo>> {
    const path = join(await this.modelsOfErrors(), "models_info.json");
    const json = parsedJson("models_info.json", await read("models_info.json", path));
    const entries = isRecord(json) ? Object.entries(json) : [];
    return new Map(entries.map(([id, entry]) => [Number(id), infoOf(id, entry)]));
  }

  async #visible(scenes: readonly string[]): Promise<BopTarget[]> {
    const targets: BopTarget[] = [];
    for (const name of scenes) {
      const sceneId = Number(name);
      const { truths, visible } = await this.scene(sceneId);
      for (const [image, poses] of truths) {
        const counts = new Map<number, number>();
        for (const [i, { obj_id = 0 }] of poses.entries()) {
          if ((visible.get(image)?.[i] ?? 1) >= LEAST_VISIBLE) counts.set(obj_id, (counts.get(obj_id) ?? 0) + 1);
        }
        const ids = [...counts.keys()].sort((a, b) => a - b);
        for (const id of ids)
          targets.push({ sceneId, imageId: Number(image), objectId: id, count: counts.get(id) ?? 0 });
      }
    }
    return targets;
  }
}

/** The places in `scene_gt.json` of an object's most visible instances in an image, the most visible one first. */
export function mostVisible({ truths, visible }: BopScene, { imageId, objectId, count }: BopTarget): number[] {
  const image = bopId(imageId);
  const places = [...(truths.get(image) ?? []).entries()].filter(([, { obj_id }]) => obj_id === objectId);
  const fraction = (place: number) => visible.get(image)?.[place] ?? 1;
  return places
    .map(([place]) => place)
    .sort((a, b) => fraction(b) - fraction(a) || a - b)
    .slice(0, count);
}

function targetOf(entry: unknown): BopTarget {
  const { scene_id, im_id, obj_id, inst_count } = isRecord(entry) ? entry : {};
  const ids = [scene_id, im_id, obj_id, inst_count];
  if (!ids.every((id) => Number.isSafeInteger(id) && (id as number) >= 0)) throw noTarget(shown(entry));
  const [sceneId, imageId, objectId, count] = ids as [number, number, number, number];
  return { sceneId, imageId, objectId, count };
}

function noTarget(found: string) {
  const expected = "a list of { scene_id, im_id, obj_id, inst_count }";
  const remedy = "Pass the targets of localization, such as test_targets_bop19.json.";
  return failure("CORRUPT_FILE", "targets", found, expected, remedy);
}

function infoOf(id: string, entry: unknown): BopModelInfo {
  const argument = `models_info.json: ${id}`;
  const invalid = (found: string, expected: string) =>
    failure("CORRUPT_FILE", argument, found, expected, "See the format of BOP datasets.");
  const { diameter, symmetries_discrete = [], symmetries_continuous = [] } = isRecord(entry) ? entry : {};
  if (!isNumber(diameter) || diameter <= 0) throw invalid(shown(diameter), "a diameter in millimetres");
  const list = (value: unknown, name: string) => {
    if (!Array.isArray(value)) throw invalid(shown(value), `a list of ${name}`);
    return value as unknown[];
  };
  const numbers = (value: unknown, count: number, name: string) => {
    const found = numbersIn(value, count);
    if (found === null) throw invalid(shown(value), `${count} numbers in ${name}`);
    return found;
  };
  const discrete = list(symmetries_discrete, "symmetries_discrete").flatMap((symmetry) =>
    numbers(symmetry, 16, "symmetries_discrete"),
  );
  const continuous = list(symmetries_continuous, "symmetries_continuous").flatMap((symmetry) => {
    const { axis, offset } = isRecord(symmetry) ? symmetry : {};
    return [...numbers(axis, 3, "axis"), ...numbers(offset, 3, "offset")];
  });
  return {
    diameterMm: diameter,
    discrete: Float64Array.from(discrete),
    continuous: Float64Array.from(continuous),
  };
}
