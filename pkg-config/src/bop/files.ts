/** Files that methods exchange with BOP: 2D detections, and the results of the leaderboard. */
import type { CocoRle } from "../types/inputs.js";
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { type BopPlace, imageKey } from "./dataset.js";

/** An object that a detector found, such as CNOS. */
export interface Detection extends BopPlace {
  mask: CocoRle;
  score: number;
  /** Seconds that the detections in the image took; 0 if unknown. */
  seconds: number;
}

/**
 * Reads a list of `{ scene_id, image_id, category_id, score, segmentation }`, the masks in COCO's run-length encoding.
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` for other content
 */
export function readDetections(text: string): Detection[] {
  let entries: unknown;
  try {
    entries = JSON.parse(text);
  } catch (error) {
    throw noDetection(`text that is not JSON: ${(error as Error).message}`);
  }
  if (!Array.isArray(entries)) throw noDetection("JSON that is no list");
  return entries.map((entry, index) => {
    const { scene_id, image_id, category_id, score, segmentation, time } = isRecord(entry) ? entry : {};
    const ids = [scene_id, image_id, category_id];
    if (!ids.every(Number.isSafeInteger) || !isNumber(score) || !isRecord(segmentation))
      throw noDetection(`entry ${index}`);
    const [sceneId, imageId, objectId] = ids as [number, number, number];
    const seconds = isNumber(time) && time > 0 ? time : 0;
    // The runs are checked when the mask is used.
    return { sceneId, imageId, objectId, mask: segmentation as unknown as CocoRle, score, seconds };
  });
}

function noDetection(found: string) {
  const expected = "a list of { scene_id, image_id, category_id, score, segmentation: { size, counts } }";
  const remedy = 'Pass detections in the format of BOP, or "gt" for the masks of the dataset.';
  return failure("CORRUPT_FILE", "masks", found, expected, remedy);
}

/** The first line of a results file. */
export const RESULTS_HEADER = "scene_id,im_id,obj_id,score,R,t,time";

/** The place of a result: an instance of a target. */
export interface BopInstance extends BopPlace {
  /** Score of the detection, 0 to 1; 1 where the mask is known. */
  detectionScore: number;
  /** Seconds that the detections in the image took; 0 if unknown. */
  detectionSeconds: number;
}

/** The properties of an entry that a results file needs. */
interface PoseEntry {
  diagnostics?: { timingsMs: { total: number } };
  confidence?: number;
  rotationMatrix?: number[][];
  translation?: number[];
}

/** The results of a batch, of which each row has the time of its whole image. */
export class BopResults {
  readonly #rows = new Map<string, string>();
  readonly #seconds = new Map<string, number>();

  /** @param instances what the cases are, by their names, in the order of the rows */
  constructor(private readonly instances: ReadonlyMap<string, BopInstance>) {}

  add(name: string, entry: object): void {
    const instance = this.instances.get(name);
    if (instance === undefined) return;
    const { sceneId, imageId, objectId, detectionScore, detectionSeconds } = instance;
    const { diagnostics, confidence, rotationMatrix, translation } = entry as PoseEntry;
    const seconds = this.#seconds.get(imageKey(instance)) ?? detectionSeconds;
    this.#seconds.set(imageKey(instance), seconds + (diagnostics?.timingsMs.total ?? 0) / 1000);
    // A case that failed has no pose.
    if (rotationMatrix === undefined || translation === undefined) return;
    const score = (confidence ?? 1) * detectionScore;
    // Other scales than that of millimetres change the unit of the model, not of the scene.
    const millimetres = translation.map((x) => 1000 * x);
    const cells = [sceneId, imageId, objectId, score, rotationMatrix.flat().join(" "), millimetres.join(" ")];
    this.#rows.set(name, cells.join(","));
  }

  /** The results file. */
  text(): string {
    const lines = [...this.instances].flatMap(([name, instance]) => {
      const row = this.#rows.get(name);
      return row === undefined ? [] : [`${row},${this.#seconds.get(imageKey(instance)) ?? -1}`];
    });
    return [RESULTS_HEADER, ...lines, ""].join("\n");
  }
}
