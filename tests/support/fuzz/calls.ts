/** Calls with odd arguments. Each must settle, with a result or with an error of a kind that callers can handle. */
import assert from "node:assert/strict";
import { type Aligner, createAligner, OPTIONS, type OptionRow, Sim3AlignError, type Tracker } from "sim3align";
import {
  externalResources,
  readCamera,
  readCase,
  readDepth,
  readMask,
  readMesh,
  readPose,
  readSam3d,
  readScene,
} from "sim3align/formats";
import type { Random } from "../random.js";
import { columnMajor, truth } from "../scene.js";
import { type Fields, mutate } from "./mutations.js";
import { oddValue, pick, proxied, Thrown } from "./odd-values.js";
import { randomPicture } from "./pictures.js";

/** What became of a call. */
export type Outcome = { result: unknown } | { error: unknown };

/** Waits for a call that may also throw at once. */
export async function outcomeOf(call: () => unknown): Promise<Outcome> {
  try {
    return { result: await call() };
  } catch (error) {
    return { error };
  }
}

/** Codes of faults that no argument may cause. */
const faults = ["INTERNAL", "WORKER_FAILED", "NOT_INITIALISED"];

/**
 * Checks the error of a call.
 * @param reasons what the caller's functions and signals threw
 * @param allowed codes that the circumstances explain
 */
export function checkError(error: unknown, reasons: readonly unknown[] = [], allowed: readonly string[] = []): void {
  if (error instanceof Thrown || reasons.includes(error) || isOfListener(error) || isOfProxy(error)) return;
  if (!(error instanceof Sim3AlignError)) throw new Error("an error without type", { cause: error });
  const { code, argument, found, expected, remedy, message } = error;
  if (faults.includes(code) && !allowed.includes(code)) throw new Error(`a fault: ${message}`, { cause: error });
  for (const part of [argument, found, expected, remedy]) assert.ok(part.trim() !== "", `an empty part: ${message}`);
  // A message may quote that of the cause.
  if (error.cause === undefined) assert.doesNotMatch(message, /\bundefined\b|\[object|NaN ×/, message);
}

/** Whether a function of the caller threw this when it was called: a class is one that cannot be called. */
const isOfListener = (error: unknown) =>
  error instanceof TypeError && /^Class constructor WithAccessors cannot be invoked/.test(error.message);

/** Whether a proxy of the caller threw this when it was read: it contradicts its target. */
const isOfProxy = (error: unknown) =>
  error instanceof TypeError && /^'get' on proxy: property .* read-only and non-configurable/.test(error.message);

/** Options that may be valid. */
function options(random: Random, method: keyof typeof OPTIONS): Fields {
  const given: Fields = ["align", "alignViews", "track"].includes(method) ? { quality: "fast" } : {};
  for (const { name, default: value, choices } of OPTIONS[method] as readonly OptionRow[]) {
    const chance = random.between(0, 1);
    if (chance < 0.04) given[name] = oddValue(random);
    else if (chance < 0.08) given[name] = choices === undefined ? value : pick(random, choices);
  }
  if (method === "paper") Object.assign(given, { preset: "paper", ransacIterations: 200 });
  const chance = random.between(0, 1);
  if (chance < 0.05) given[pick(random, ["workers", "qualty", "__proto__", "constructor", ""])] = oddValue(random);
  else if (chance < 0.1) given.signal = oddValue(random);
  else if (chance < 0.15) given.onProgress = oddValue(random);
  else if (chance < 0.25) given.transfer = random.between(0, 1) < 0.9 ? true : oddValue(random);
  else if (chance < 0.3) given.onProgress = async () => Promise.reject(new Thrown("of an async function"));
  return given;
}

/** An argument that is valid, odd, or something between. */
function argument<T extends object>(random: Random, valid: T): T {
  const chance = random.between(0, 1);
  if (chance < 0.06) return oddValue(random) as T;
  const count = chance < 0.3 ? 0 : chance < 0.7 ? 1 : random.whole(2, 4);
  for (let i = 0; i < count; i++) mutate(random, valid);
  return chance > 0.97 ? (proxied(random, valid) as T) : valid;
}

type Call = (aligner: Aligner, random: Random, allowed: readonly string[]) => () => unknown;
const input = (random: Random) => argument(random, randomPicture(random)) as never;
const cloud = (random: Random) => {
  const values = random.list(random.whole(0, 40) * 3, -1, 1);
  const holder: Fields = { cloud: random.between(0, 1) < 0.5 ? Float32Array.from(values) : Float64Array.from(values) };
  if (random.between(0, 1) < 0.4) mutate(random, holder);
  return outcomeValue(holder, "cloud");
};

/** The value of a property that may be a getter that throws: the fuzzer itself must not fail. */
function outcomeValue(holder: Fields, name: string): never {
  try {
    return holder[name] as never;
  } catch {
    return undefined as never;
  }
}

/** A frame of several, with or without mask, photo and the pose of its camera. */
function frame(random: Random, isPosed: boolean): Fields {
  const { mesh: _, ...given } = randomPicture(random);
  if (random.between(0, 1) < 0.2) delete given.mask;
  const size = pick(random, [
    [16, 12],
    [32, 24],
    [5, 7],
  ] as const);
  const image = { data: new Uint8Array(3 * size[0] * size[1]).fill(90), width: size[0], height: size[1] };
  if (random.between(0, 1) < 0.2) given.image = image;
  if (isPosed && random.between(0, 1) < 0.5) given.cameraToWorld = pose(random, 1);
  return given;
}

/** A pose in one of its forms. */
function pose(random: Random, scale: number): object {
  const translation = truth.translation.map((x) => x * random.between(0.9, 1.1)) as typeof truth.translation;
  const moved = { ...truth, scale, translation };
  return pick<object>(random, [moved, { matrix: columnMajor(moved) }, Float64Array.from(columnMajor(moved))]);
}

/** A frame for a tracker, or a correction. */
function trackerStep(random: Random): (tracker: Tracker) => unknown {
  if (random.between(0, 1) < 0.7) {
    const [given, own] = [argument(random, frame(random, false)), random.between(0, 1) < 0.9 ? [] : [oddValue(random)]];
    return (tracker) => tracker.next(given as never, ...(own as never[]));
  }
  const given = argument(random, pose(random, truth.scale));
  const number = pick(random, [undefined, 0, 1, 99, oddValue(random)]);
  return (tracker) => tracker.correct(given as never, number as never);
}

const readers = [
  readDepth,
  readMask,
  readMesh,
  readCamera,
  readPose,
  readCase,
  readScene,
  readSam3d,
  externalResources,
];

const calls: readonly Call[] = [
  ...Array<Call>(6).fill((aligner, random) => {
    const [given, own] = [input(random), argument(random, options(random, pick(random, ["align", "paper"] as const)))];
    return () => aligner.align(given, own);
  }),
  ...Array<Call>(2).fill((aligner, random) => {
    const forms: object[] = [{ ...truth }, { matrix: columnMajor(truth) }, Float64Array.from(columnMajor(truth))];
    const [given, transform] = [input(random), argument(random, pick(random, forms))];
    const own = argument(random, options(random, "evaluate"));
    return () => aligner.evaluate(given, transform as never, own);
  }),
  (aligner, random) => {
    const [source, target, own] = [cloud(random), cloud(random), options(random, "register")];
    return () => aligner.register(source, target, { ransacIterations: 100, ...own });
  },
  (aligner, random) => {
    const [source, target, own] = [cloud(random), cloud(random), options(random, "estimateSim3")];
    const pairs = random.between(0, 1) < 0.5 ? (oddValue(random) as never) : new Uint32Array(12);
    return () => aligner.estimateSim3(source, target, pairs, own);
  },
  ...Array<Call>(2).fill((aligner, random) => {
    const views = Array.from({ length: random.whole(0, 3) }, () => argument(random, frame(random, true)));
    const { mesh } = randomPicture(random);
    const given = argument(random, { mesh, views: random.between(0, 1) < 0.05 ? oddValue(random) : views });
    const own = argument(random, { ...options(random, "alignViews") });
    return () => aligner.alignViews(given as never, own);
  }),
  (aligner, random, allowed) => {
    const mesh = outcomeValue(argument(random, randomPicture(random)) ?? {}, "mesh");
    const own = argument(random, { ...options(random, "track") });
    const steps = Array.from({ length: random.whole(1, 4) }, () => trackerStep(random));
    return async () => {
      const tracker = await aligner.track(mesh, own);
      let last: Outcome = { result: undefined };
      try {
        for (const step of steps) {
          const outcome = await outcomeOf(() => step(tracker));
          if ("error" in outcome) {
            checkError(outcome.error, [], allowed);
            last = outcome;
          }
        }
      } finally {
        tracker.close();
      }
      // Errors leave the tracker usable; the last one is the same with workers and without.
      if ("error" in last) throw last.error;
    };
  },
  (aligner, random) => {
    const mesh = outcomeValue(argument(random, randomPicture(random)) ?? {}, "mesh");
    return async () => (await aligner.prepareMesh(mesh)).dispose();
  },
  (aligner, random, allowed) => {
    const inputs = random.between(0, 1) < 0.3 ? oddValue(random) : [input(random), input(random)];
    const own = options(random, "align");
    return async () => {
      for await (const { error } of aligner.alignAll(inputs as never, own))
        if (error !== undefined) checkError(error, [], allowed);
    };
  },
  (_, random) => {
    const own = argument(random, { workers: random.whole(0, 1) } as Fields);
    return async () => (await createAligner(own)).dispose();
  },
  ...Array<Call>(2).fill((_, random) => {
    const read = pick<unknown>(random, readers) as typeof readDepth;
    const picture = argument(random, randomPicture(random)) ?? {};
    const file = outcomeValue(picture as Fields, pick(random, ["depth", "mask", "mesh", "camera", "cameraFile"]));
    const own = random.between(0, 1) < 0.5 ? [] : [oddValue(random) as never];
    return () => read(file, ...own);
  }),
];

/**
 * A call with arguments of this seed, which are new each time.
 * @param allowed codes that the circumstances explain
 */
export const randomCall = (aligner: Aligner, random: Random, allowed: readonly string[] = []) =>
  pick(random, calls)(aligner, random, allowed);
