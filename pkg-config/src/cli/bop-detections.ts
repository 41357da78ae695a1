/** 2D detections in the format of BOP: masks of objects that a detector found, such as those of CNOS. */
import { readFileSync } from "node:fs";
import type { BopTarget } from "../bop-dataset.js";
import { isNumber } from "../formats/json.js";
import type { CocoRle } from "../input/types.js";
import { failure, isRecord } from "../values.js";
import { best } from "./bop-scores.js";
import { UsageError } from "./usage-error.js";

/** A detection. */
export interface Detection {
  /** The mask. */
  mask: CocoRle;
  score: number;
  /** Seconds that the detections in the image took; 0 if unknown. */
  seconds: number;
}

/** The detections of a file. */
export class Detections {
  readonly #of = new Map<string, Detection[]>();

  /**
   * Reads a list of `{ scene_id, image_id, category_id, score, segmentation }`, the masks in COCO's run-length encoding.
   * @throws {@link UsageError} if the file cannot be read
   * @throws {@link Sim3AlignError} `CORRUPT_FILE` for other content
   */
  constructor(path: string) {
    const entries = jsonOf(path);
    if (!Array.isArray(entries)) throw noDetection("JSON that is no list");
    for (const [i, entry] of entries.entries()) {
      const { scene_id, image_id, category_id, score, segmentation, time } = isRecord(entry) ? entry : {};
      const ids = [scene_id, image_id, category_id];
      if (!ids.every(Number.isSafeInteger) || !isNumber(score) || !isRecord(segmentation))
        throw noDetection(`entry ${i}`);
      const key = ids.join("/");
      const seconds = isNumber(time) && time > 0 ? time : 0;
      const others = this.#of.get(key) ?? [];
      // The runs are checked when the mask is used.
      others.push({ mask: segmentation as unknown as CocoRle, score, seconds });
      this.#of.set(key, others);
    }
  }

  /** The detections of a target with the highest scores, at most as many as there are instances. */
  of({ sceneId, imageId, objectId, count }: BopTarget): Detection[] {
    return best(this.#of.get(`${sceneId}/${imageId}/${objectId}`) ?? [], count);
  }
}

function jsonOf(path: string): unknown {
  let text: string;
  try {
    text = readFileSync(path, "utf8");
  } catch (error) {
    throw new UsageError(`--masks ${path}: the file cannot be read: ${(error as Error).message}.`);
  }
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
