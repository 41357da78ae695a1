/** Random calls, some with odd arguments, without workers and with one: both settle, and with the same outcome. */
import assert from "node:assert/strict";
import { type Aligner, createAligner, OPTIONS, type OptionRow, Sim3AlignError } from "sim3align";
import {
  readCamera,
  readCase,
  readDepth,
  readFrames,
  readMask,
  readMesh,
  readPose,
  readSam3d,
} from "sim3align/formats";
import { cocoRle, glb, maskPng, npy, obj } from "./files.js";
import { Random } from "./random.js";
import { withoutTimes } from "./results.js";
import { blob, columnMajor, input, render, truth } from "./scene.js";

type Fields = Record<string, unknown>;

const pick = <T>(random: Random, items: readonly T[]): T => items[random.whole(0, items.length - 1)] as T;
const object = blob(7, 9);
const [width, height] = [32, 24];
const view = render(object, truth, { fx: 60, fy: 60, cx: 15.5, cy: 11.5 }, width, height);

/** A scene in one of the forms that `align` takes, with copies of all arrays. */
function scene(random: Random): Fields {
  const { depth, mask, camera } = view;
  const { fx, fy, cx, cy } = camera;
  const depths = [
    { depth: depth.slice(), width, height },
    { depth: { data: Uint16Array.from(depth, (z) => 1000 * z), width, height }, depthScale: 0.001 },
    { depth: npy(depth, height, width) },
    { depth: depth.map((z) => 3 / z - 1), width, height, depthKind: "affine-invariant-disparity" },
  ];
  const masks = [mask.slice(), cocoRle(mask, width, height), maskPng(mask, width, height)];
  const cameras = [{ ...camera }, { K: [fx, 0, cx, 0, fy, cy, 0, 0, 1] }, { fovYDeg: 30 }, undefined];
  const meshes = [{ ...structuredClone(object) }, glb(object), obj(object)];
  return {
    ...pick(random, depths),
    mask: pick(random, masks),
    camera: pick(random, cameras),
    mesh: pick(random, meshes),
  };
}

function detached(): Float32Array {
  const array = new Float32Array(9);
  structuredClone(array, { transfer: [array.buffer] });
  return array;
}

/** Values of every kind that a caller without types may pass. */
const makers: ((random: Random) => unknown)[] = [
  ...[() => undefined, () => null, () => true, () => 5n],
  (random) => pick(random, [0, -0, -1, 0.5, 3, 2 ** 31, 2 ** 53, 1e300, Number.NaN, Number.POSITIVE_INFINITY]),
  (random) => pick(random, ["", "160", "best", "__proto__", "{", '{"fx":1}', "\ud800", "x".repeat(5000)]),
  ...[() => ({}), () => [], () => Object.create(null), () => ({ scale: 1 }), () => new Date(Number.NaN)],
  (random) => random.list(random.whole(0, 20), -2, 2),
  (random) => ({ data: odd(random), width: pick(random, [0, 3, 32]), height: 3 }),
  (random) =>
    new (pick(random, [Float32Array, Float64Array, Uint8Array, Uint16Array, Int32Array]))(random.whole(0, 99)),
  ...[detached, () => new Float32Array(new SharedArrayBuffer(36)), () => new ArrayBuffer(8)],
  ...[() => Buffer.from("neither JSON nor glTF"), () => new Blob([new Uint8Array(8)])],
  () => new Proxy({ width: 1 }, { get: (target, name) => Reflect.get(target, name) }),
];
const odd = (random: Random): unknown => pick(random, makers)(random);

/** Changes one of the properties of an argument, or of the plain objects in it. */
function mutated(random: Random, valid: Fields): Fields {
  for (let count = pick(random, [0, 1, 1, 1, 2, 3]); count > 0; count--) {
    const names = [...Object.keys(valid), "width", "depthScale", "qualty"];
    const name = pick(random, names);
    const value = valid[name];
    const isPlain = typeof value === "object" && value !== null && Object.getPrototypeOf(value) === Object.prototype;
    if (isPlain && random.between(0, 1) < 0.6) mutated(random, value as Fields);
    else if (random.between(0, 1) < 0.1) delete valid[name];
    else valid[name] = odd(random);
  }
  return valid;
}

// The calls take what they must refuse, so the values have the type that every parameter accepts.
const argument = (random: Random, valid: Fields) =>
  (random.between(0, 1) < 0.05 ? odd(random) : mutated(random, valid)) as never;

function options(random: Random, method: keyof typeof OPTIONS): never {
  const given: Fields = ["align", "alignViews", "track"].includes(method) ? { quality: "fast" } : {};
  if (method === "paper") Object.assign(given, { preset: "paper", ransacIterations: 200 });
  for (const { name, default: value, choices } of OPTIONS[method] as readonly OptionRow[]) {
    if (random.between(0, 1) < 0.06) given[name] = pick(random, choices === undefined ? [value, odd(random)] : choices);
  }
  return argument(random, given);
}

const frame = (random: Random) => mutated(random, { ...scene(random), mesh: undefined }) as never;
const pose = (random: Random) => pick<unknown>(random, [truth, { matrix: columnMajor(truth) }, odd(random)]) as never;
const cloud = (random: Random) => pick(random, [Float32Array.from(random.list(60, -1, 1)), odd(random)]) as never;
const readers = [readDepth, readMask, readMesh, readCamera, readPose, readCase, readFrames, readSam3d];

/** The calls; each draws its arguments from the generator. */
const calls: readonly ((aligner: Aligner, random: Random) => unknown)[] = [
  ...(["align", "align", "paper"] as const).map(
    (method) => (aligner: Aligner, random: Random) =>
      aligner.align(argument(random, scene(random)), options(random, method)),
  ),
  (aligner, random) => aligner.evaluate(argument(random, scene(random)), pose(random), options(random, "evaluate")),
  (aligner, random) => aligner.register(cloud(random), cloud(random), options(random, "register")),
  (aligner, random) => {
    const views = { mesh: scene(random).mesh, views: [frame(random), frame(random)] };
    return aligner.alignViews(argument(random, views), options(random, "alignViews"));
  },
  async (aligner, random) => {
    using tracker = await aligner.track(scene(random).mesh as never, options(random, "track"));
    const frames = [frame(random), frame(random)] as const;
    return [await tracker.next(frames[0]), await tracker.next(frames[1])];
  },
  async (aligner, random) => (await aligner.prepareMesh(argument(random, scene(random)))).dispose(),
  (_, random) => pick<typeof readMesh>(random, readers as never)(pick(random, Object.values(scene(random))) as never),
];

/** Makes an execution: it runs the call of a seed with each aligner, and compares the outcomes. */
export async function fuzzer(): Promise<{ run(seed: number): Promise<void>; end(): Promise<void> }> {
  const aligners = await Promise.all([0, 1].map((workers) => createAligner({ workers })));
  const bits = async (aligner: Aligner) => withoutTimes(await aligner.align(input, { quality: "fast" }));
  const expected = await bits(aligners[0] as Aligner);
  /** A result, or the error, which has to be one that callers can handle. */
  async function outcome(aligner: Aligner, seed: number): Promise<string> {
    const random = new Random(seed);
    try {
      await pick(random, calls)(aligner, random);
      return "a result";
    } catch (error) {
      assert.ok(error instanceof Sim3AlignError, `seed ${seed}: ${(error as Error)?.stack}`);
      const { code, argument, message } = error;
      assert.ok(!["INTERNAL", "WORKER_FAILED", "NOT_INITIALISED"].includes(code), `seed ${seed}: ${message}`);
      return `${code} ${argument}`;
    }
  }
  return {
    async run(seed) {
      const [here, there] = [await outcome(aligners[0] as Aligner, seed), await outcome(aligners[1] as Aligner, seed)];
      assert.equal(there, here, `seed ${seed}: another outcome in a worker`);
    },
    async end() {
      for (const aligner of aligners) assert.deepEqual(await bits(aligner), expected, "other bits afterwards");
      for (const aligner of aligners) aligner.dispose();
    },
  };
}
