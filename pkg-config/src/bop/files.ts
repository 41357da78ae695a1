/** Files that methods exchange with BOP: 2D detections, and the results of the leaderboard. */
import { type Matrix3, rotationOf } from "../conventions/rotation.js";
import { sim3Of } from "../conventions/similarity.js";
import type { Sim3 } from "../generated/types.js";
import type { CocoRle } from "../types/inputs.js";
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { type BopPlace, imageKey, METRES_PER_UNIT } from "./dataset.js";

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
/** Number of values in each column. */
const COUNTS = [1, 1, 1, 1, 9, 3, 1];

/** A row of a results file. */
export interface BopResult extends BopPlace {
  score: number;
  /** Camera from model, metres. */
  pose: Sim3;
  /** Seconds for the whole image; −1 if unknown. */
  seconds: number;
}

/**
 * Reads a results file.
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` for other content
 */
export const readResults = (text: string): BopResult[] =>
  text
    .split(/\r?\n/)
    .flatMap((line, i) =>
      line.trim() === "" || (i === 0 && line.includes(RESULTS_HEADER)) ? [] : [resultOf(line, i)],
    );

function resultOf(line: string, index: number): BopResult {
  const numbers = line.split(",").map((cell) => cell.trim().split(/\s+/).map(Number));
  const isComplete = numbers.length === COUNTS.length && COUNTS.every((count, i) => numbers[i]?.length === count);
  if (!isComplete || numbers.flat().some((x) => !Number.isFinite(x))) {
    const remedy = "Check the line: R has nine numbers, row by row, and t three, in millimetres.";
    throw failure("CORRUPT_FILE", "results", `line ${index + 1}: ${line.slice(0, 60)}`, RESULTS_HEADER, remedy);
  }
  const [sceneId = 0, imageId = 0, objectId = 0, score = 0, ...rest] = numbers.flat();
  const [rotation, [x = 0, y = 0, z = 0], seconds = -1] = [rest.slice(0, 9), rest.slice(9, 12), rest[12]];
  const pose = sim3Of({
    scale: METRES_PER_UNIT,
    rotation: rotationOf("results.R", rotation as unknown as Matrix3),
    translation: [x / 1000, y / 1000, z / 1000],
  });
  return { sceneId, imageId, objectId, score, pose, seconds };
}

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
