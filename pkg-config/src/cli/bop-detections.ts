/** 2D detections in the format of BOP: masks of objects that a detector found, such as those of CNOS. */

import { type BopTarget, targetKey } from "../bop-dataset.js";
import { isNumber } from "../formats/json.js";
import type { CocoRle } from "../input/types.js";
import { failure } from "../values/error.js";
import { isRecord } from "../values/values.js";
import { best, grouped } from "./bop-scores.js";
import { textOf } from "./parse.js";

/** A detection. */
export interface Detection extends Omit<BopTarget, "count"> {
  /** The mask. */
  mask: CocoRle;
  score: number;
  /** Seconds that the detections in the image took; 0 if unknown. */
  seconds: number;
}

/** The detections of a file. */
export class Detections {
  readonly #byTarget: ReadonlyMap<string, Detection[]>;

  /**
   * Reads a list of `{ scene_id, image_id, category_id, score, segmentation }`, the masks in COCO's run-length encoding.
   * @throws {@link UsageError} if the file cannot be read
   * @throws {@link Sim3AlignError} `CORRUPT_FILE` for other content
   */
  constructor(path: string) {
    const entries = jsonOf(path);
    if (!Array.isArray(entries)) throw noDetection("JSON that is no list");
    this.#byTarget = grouped(entries.map(detectionOf), targetKey);
  }

  /** The detections of a target with the highest scores, at most as many as there are instances. */
  of(target: BopTarget): Detection[] {
    return best(this.#byTarget.get(targetKey(target)) ?? [], target.count);
  }
}

function detectionOf(entry: unknown, index: number): Detection {
  const { scene_id, image_id, category_id, score, segmentation, time } = isRecord(entry) ? entry : {};
  const ids = [scene_id, image_id, category_id];
  if (!ids.every(Number.isSafeInteger) || !isNumber(score) || !isRecord(segmentation)) {
    throw noDetection(`entry ${index}`);
  }
  const [sceneId, imageId, objectId] = ids as [number, number, number];
  const seconds = isNumber(time) && time > 0 ? time : 0;
  // The runs are checked when the mask is used.
  return { sceneId, imageId, objectId, mask: segmentation as unknown as CocoRle, score, seconds };
}

function jsonOf(path: string): unknown {
  const text = textOf("--masks", path);
  try {
    return JSON.parse(text);
  } catch (error) {
    throw noDetection(`text that is not JSON: ${(error as Error).message}`);
  }
}

function noDetection(found: string) {
  const expected = "a list of { scene_id, image_id, category_id, score, segmentation: { size, counts } }";
  const remedy = 'Pass detections in the format of BOP, or "gt" for the masks of the dataset.';
  return failure("CORRUPT_FILE", "masks", found, expected, remedy);
}
