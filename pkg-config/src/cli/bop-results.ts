/** The results file of BOP's leaderboard. */

import { writeFileSync } from "node:fs";
import { type BopTarget, imageKey } from "../bop-dataset.js";
import { type Matrix3, rotationOf } from "../conventions/rotation.js";
import { sim3Of } from "../conventions/similarity.js";
import type { Sim3 } from "../input/sim3.js";
import { failure } from "../values/error.js";
import type { EntrySink } from "./output.js";
import { textOf } from "./parse.js";
import { UsageError } from "./usage-error.js";
import { checkWritable } from "./writable.js";

const HEADER = "scene_id,im_id,obj_id,score,R,t,time";

/** BOP's models are in millimetres. */
export const METRES_PER_UNIT = 0.001;

/** The place of a result: an instance of a target. */
export interface BopInstance extends Omit<BopTarget, "count"> {
  /** Score of the detection, 0 to 1; 1 where the mask is known. */
  detectionScore: number;
  /** Seconds that the detections in the image took; 0 if unknown. */
  detectionSeconds: number;
}

/** A row of a results file. */
export interface BopResult extends Omit<BopTarget, "count"> {
  score: number;
  /** Camera from model, metres. */
  pose: Sim3;
  /** Seconds for the whole image; −1 if unknown. */
  seconds: number;
}

/**
 * The name of a results file: `METHOD_DATASET-SPLIT[_NAME].csv`, as the leaderboard reads it.
 * @throws {@link UsageError} for names that would be read as other parts
 */
export function resultsName(method: string, dataset: string, split: string, name?: string): string {
  for (const [flag, part] of Object.entries({ method, csv: name })) {
    if (part !== undefined && !/^[A-Za-z0-9-]+$/.test(part))
      throw new UsageError(
        `--${flag} ${part}: only letters, digits and "-" can be part of the name of a results file.`,
      );
  }
  return `${method}_${dataset}-${split.replaceAll("_", "-")}${name === undefined ? "" : `_${name}`}.csv`;
}

/** Collects the poses of a batch, and writes them at its end: each row has the time of its whole image. */
export class BopResultsFile implements EntrySink {
  readonly #path: string;
  readonly #instances: ReadonlyMap<string, BopInstance>;
  readonly #rows = new Map<string, string[]>();
  readonly #seconds = new Map<string, number>();

  /**
   * @param instances what the cases are, by their names, in the order of the rows
   * @throws {@link UsageError} if the file cannot be written
   */
  constructor(path: string, instances: ReadonlyMap<string, BopInstance>) {
    checkWritable("--csv", path);
    this.#path = path;
    this.#instances = instances;
  }

  add(name: string, entry: object): void {
    const instance = this.#instances.get(name);
    if (instance === undefined) return;
    const image = imageKey(instance);
    const { timingsMs, confidence, rotation, translation, scale } = entry as {
      timingsMs?: { total: number };
      confidence?: number | null;
      rotation?: number[][];
      translation?: number[];
      scale?: number;
    };
    const seconds = this.#seconds.get(image) ?? instance.detectionSeconds;
    this.#seconds.set(image, seconds + (timingsMs?.total ?? 0) / 1000);
    // A case that failed has no pose.
    if (rotation === undefined || translation === undefined || scale === undefined) return;
    const { sceneId, imageId, objectId, detectionScore } = instance;
    const score = (confidence ?? 1) * detectionScore;
    // Other scales than that of millimetres change the unit of the model, not of the scene.
    const millimetres = translation.map((x) => 1000 * x);
    this.#rows.set(name, [
      ...[sceneId, imageId, objectId, score].map(String),
      rotation.flat().join(" "),
      millimetres.join(" "),
    ]);
  }

  end(): void {
    const lines = [...this.#instances].flatMap(([name, instance]) => {
      const row = this.#rows.get(name);
      return row === undefined ? [] : [[...row, this.#seconds.get(imageKey(instance)) ?? -1].join(",")];
    });
    writeFileSync(this.#path, [HEADER, ...lines, ""].join("\n"));
  }
}

/**
 * Reads a results file.
 * @throws {@link UsageError} if it cannot be read
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` for other content
 */
export function readResults(path: string): BopResult[] {
  const lines = textOf("--evaluate", path).split(/\r?\n/);
  return lines.flatMap((line, i) =>
    line.trim() === "" || (i === 0 && line.includes(HEADER)) ? [] : [resultOf(line, i)],
  );
}

function resultOf(line: string, index: number): BopResult {
  const cells = line.split(",");
  const numbers = cells.map((cell) => cell.trim().split(/\s+/).map(Number));
  const lengths = [1, 1, 1, 1, 9, 3, 1];
  const isComplete = lengths.length === cells.length && lengths.every((length, i) => numbers[i]?.length === length);
  if (!isComplete || numbers.flat().some((x) => !Number.isFinite(x))) {
    const remedy = "Check the line: R has nine numbers, row by row, and t three, in millimetres.";
    throw failure("CORRUPT_FILE", "results", `line ${index + 1}: ${line.slice(0, 60)}`, HEADER, remedy);
  }
  const [[sceneId = 0], [imageId = 0], [objectId = 0], [score = 0], R, t, [seconds = -1]] = numbers as [
    ...[number[], number[], number[], number[], number[], number[], number[]],
  ];
  const translation = t.map((x) => x / 1000) as [number, number, number];
  const rotation = rotationOf("results.R", R as unknown as Matrix3);
  return {
    sceneId,
    imageId,
    objectId,
    score,
    pose: sim3Of({ scale: METRES_PER_UNIT, rotation, translation }),
    seconds,
  };
}
