/** Bad arguments of every call: a typed error with its code, the argument, and what to do; and an aligner that works on. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, type AlignOptions, createAligner, Sim3AlignError, type Sim3Like } from "sim3align";
import { type Refusals, refuses, rejectsWith } from "../support/errors.js";
import { glb, gltfJson, png } from "../support/files.js";
import { entries, helperCalls } from "../support/helper-calls.js";
import { withoutTimes } from "../support/results.js";
import { input, mesh, truth, view } from "../support/scene.js";
import { poses, tableScene, tableView } from "../support/table.js";

const aligner = await createAligner();
const quick = { quality: "fast" } as const;
const expected = withoutTimes(await aligner.align(input, quick));
after(async () => assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected, "the aligner works on"));

const { width, height, depth, mask, camera } = view;
const pixels = width * height;
const size = { width, height };

const K = { cam_K: [] };
const refusesInputs = (changes: Refusals<object>) =>
  refuses(changes, (change) => aligner.align({ ...input, ...change } as AlignInput));

refusesInputs([
  [{ depth: undefined }, "INVALID_ARGUMENT depth", /found nothing, expected a Float32Array/],
  [{ depth: Array.from(depth) }, "INVALID_ARGUMENT depth", /19200.*Float32Array\.from\(depth\)/],
  [{ depth: Int32Array.from(depth) }, "INVALID_ARGUMENT depth", /Float32Array\.from\(depth\)/],
  [{ depth: new Uint8Array(pixels).fill(9) }, "EIGHT_BIT_DEPTH depth", /256 levels/],
  [{ depth: depth.slice(1) }, "WRONG_LENGTH depth", /19199 values.*160 × 120 = 19200/],
  [{ depth: new Float32Array(8193 ** 2), width: 8193, height: 8193 }, "OUT_OF_MEMORY depth", /269 MB.*268/],
  [{ width: undefined }, "INVALID_ARGUMENT width", /nothing/],
  [{ width: 160.5 }, "INVALID_ARGUMENT width", /160\.5/],
  [{ depth: { data: depth, ...size }, width: 99 }, "SIZE_MISMATCH depth", /99 × 120/],
  [{ depthScale: 0 }, "INVALID_ARGUMENT depthScale", /found 0/],
  [{ depthKind: "relative" }, "INVALID_ARGUMENT depthKind", /"affine-invariant-disparity"/],
  [{ depth_scale: 0.001 }, "INVALID_ARGUMENT input.depth_scale", /depthScale/],
  [{ pointMap: new Float32Array(3 * pixels) }, "INVALID_ARGUMENT depth", /not both/],
  [{ mask: undefined }, "INVALID_ARGUMENT mask", /found nothing, expected a Uint8Array/],
  [{ mask: Array.from(mask) }, "INVALID_ARGUMENT mask", /Uint8Array\.from\(mask\)/],
  [{ mask: Float32Array.from(mask) }, "INVALID_ARGUMENT mask", /Uint8Array\.from\(mask\)/],
  [{ mask: new Uint8ClampedArray(4 * pixels) }, "WRONG_LENGTH mask", /76800 values, 4 per pixel.*one channel/],
  [{ mask: { [Symbol.toStringTag]: "ImageData" } }, "INVALID_ARGUMENT mask", /one channel/],
  [{ mask: { data: new Uint8Array(80 * 60), width: 80, height: 60 } }, "SIZE_MISMATCH mask", /80 × 60.*resizeMask/s],
  [{ resizeMask: "bilinear" }, "INVALID_ARGUMENT resizeMask", /"nearest"/],
  [{ camera: null }, "INVALID_ARGUMENT camera", /null/],
  [{ camera: { ...camera, cx: Number.NaN } }, "INVALID_CAMERA camera.cx", /NaN/],
  [{ camera: { K: [300, 0, 0, 0, 300, 0, 80, 60, 1] } }, "INVALID_CAMERA camera.K", /transpose/],
  [{ camera: { ...camera, focalUncertainty: 100 } }, "INVALID_ARGUMENT camera.focalUncertainty", /0\.1 for 10 %/],
  [{ camera: { ...camera, width: 640, height: 400 } }, "SIZE_MISMATCH camera", /640 × 400/],
  [{ camera: { cam_K: [] } }, "INVALID_ARGUMENT camera", /cameraFile/],
  [{ camera: { focal: 600 } }, "INVALID_ARGUMENT camera", /\{ fx, fy, cx, cy \}.*`focal`/],
  [{ cameraFile: "{}" }, "INVALID_ARGUMENT cameraFile", /not both/],
  [{ camera: undefined, cameraFile: { "1": K, "2": { cam_K: [1] } } }, "INVALID_ARGUMENT imageId", /one of 1, 2/],
]);

const positioned = (positions: unknown) => ({ mesh: { ...mesh, positions } });
const indexed = (indices: unknown) => ({ mesh: { ...mesh, indices } });
const samples = { positions: new Float32Array(6), normals: new Float32Array(6), colors: new Uint8Array(6) };
const rgb = new Uint8Array(3 * pixels);
const colored = (change: object) => ({ image: rgb, mesh: { ...mesh, ...change } });

refusesInputs([
  [{ mesh: undefined }, "INVALID_ARGUMENT mesh", /found nothing/],
  [positioned([0, 0, 0]), "INVALID_ARGUMENT mesh.positions", /Float32Array\.from/],
  [positioned(mesh.positions.slice(1)), "WRONG_LENGTH mesh.positions", /multiple of 3/],
  [indexed([0, 1, 2]), "INVALID_ARGUMENT mesh.indices", /Uint32Array\.from/],
  [colored({ colors: [0, 0, 0] }), "INVALID_ARGUMENT mesh.colors"],
  [colored({ colors: new Uint8Array(mesh.positions.length), colorSpace: "rgb" }), "INVALID_OPTION mesh.colorSpace"],
  [colored({ samples: { ...samples, colors: new Uint8Array(5) } }), "WRONG_LENGTH mesh.samples"],
  [{ image: new Float32Array(3 * pixels) }, "INVALID_ARGUMENT image"],
  [{ image: { data: rgb, width } }, "INVALID_ARGUMENT image.height"],
  [{ image: { data: rgb, width: pixels, height: 1 } }, "SIZE_MISMATCH image"],
]);

const external = Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "mesh.bin" })));

refusesInputs([
  [{ mask: png(new Uint8Array(6).fill(1), 3, 2) }, "SIZE_MISMATCH mask", /3 × 2 pixels/],
  [{ mesh: external }, "INVALID_ARGUMENT mesh.resources", /mesh\.bin/],
  [{ mesh: { bytes: glb(mesh), format: "fbx" } }, "INVALID_OPTION mesh.format", /fbx/],
  [{ image: Buffer.from("RIFF\0\0\0\0WEBPVP8 ") }, "CORRUPT_FILE image", /WebP/],
]);

const options: Refusals<unknown> = [
  ["paper", "INVALID_ARGUMENT options", /string "paper"/],
  [{ qualty: "best" }, "UNKNOWN_OPTION options.qualty", /Did you mean `quality`/],
  [{ workers: 4 }, "UNKNOWN_OPTION options.workers", /createAligner\(\{ workers \}\)/],
  [{ guard: null }, "UNKNOWN_OPTION options.guard", /Pass `preset: "paper"`/],
  [{ preset: "paper", quality: "best" }, "UNKNOWN_OPTION options.quality", /Omit `preset`/],
  [{ preset: "fast" }, "INVALID_OPTION options.preset", /precise.*paper/],
  [{ seed: -1 }, "INVALID_OPTION options.seed", /-1/],
  [{ quality: "ultra" }, "INVALID_OPTION options.quality", /"ultra".*fast.*balanced.*best/],
  [{ scale: "fixed" }, "INVALID_OPTION options.scale", /"fixed".*"free"/],
  [{ knownExtentAxis: "w" }, "INVALID_OPTION options.knownExtentAxis", /longest.*z/],
  [{ symmetry: "round" }, "INVALID_OPTION options.symmetry", /"round".*"auto"/],
  [{ symmetry: [{ axis: [0, 0, 0] }] }, "INVALID_OPTION options.symmetry.axis", /other than 0/],
  [{ initial: 5 }, "INVALID_ARGUMENT options.initial", /number 5.*matrix/],
  [{ initial: { ...truth, rotation: [0, 0, 0, 0] } }, "INVALID_TRANSFORM options.initial.rotation", /quaternion/],
  [{ onProgress: "log" }, "INVALID_ARGUMENT options.onProgress", /function/],
  [{ signal: { aborted: false } }, "INVALID_ARGUMENT options.signal", /AbortSignal/],
];
refuses(options, (value) => aligner.align(input, value as AlignOptions));

const transforms: Refusals<unknown> = [
  [undefined, "INVALID_ARGUMENT transform", /transform/],
  [{ ...truth, scale: 0 }, "INVALID_TRANSFORM transform", /scale/],
  [[0.1, 0, 0, 1, 0, 0.1, 0, 2, 0, 0, 0.1, 3, 0, 0, 0, 1], "INVALID_TRANSFORM transform.matrix", /column-major/],
];
refuses(transforms, (transform) => aligner.evaluate(input, transform as Sim3Like));

const cloud = Float64Array.from(mesh.positions);
const register = (source: unknown, target: unknown = cloud, options = {}) =>
  aligner.register(source as Float64Array, target as Float64Array, options);
const estimate = (correspondences: unknown, source = cloud) =>
  aligner.estimateSim3(source, cloud, correspondences as Uint32Array);
const withNaN = cloud.map((x, i) => (i === 4 ? Number.NaN : x));

const others: Refusals<() => Promise<unknown>> = [
  [() => aligner.evaluate({ ...input, depth: undefined } as never, truth), "INVALID_ARGUMENT depth", /nothing/],
  [() => register([1, 2, 3]), "INVALID_ARGUMENT source", /Float64Array\.from/],
  [() => register(cloud, cloud, { guard: null }), "UNKNOWN_OPTION options.guard"],
  [() => estimate(Uint32Array.of(0, 0, 1, 1, 2, 2), withNaN), "NON_FINITE source", /NaN in point 1/],
  [() => estimate([0, 0]), "INVALID_ARGUMENT correspondences", /Uint32Array\.from/],
  [() => aligner.track(mesh, { quality: "nice" } as never), "INVALID_OPTION options.quality"],
  [() => drain(input), "INVALID_ARGUMENT inputs", /iterable/],
  [() => createAligner({ worker: 2 } as object), "UNKNOWN_OPTION worker", /workers/],
  [() => createAligner({ workers: -1 }), "INVALID_ARGUMENT workers", /auto/],
  [() => createAligner({ workers: 1, createWorker: "worker.js" as never }), "INVALID_ARGUMENT createWorker", /func/],
];
refuses(others, (call) => call());

async function drain(inputs: unknown): Promise<void> {
  for await (const _ of aligner.alignAll(inputs as AlignInput[])) assert.fail("no input");
}

const [first] = tableScene.objects;
const inScene = (change: object) => ({ ...tableScene, objects: [{ ...first, ...change }] });
const small = { data: new Uint8Array(4), width: 2, height: 2 };
const scenes: Refusals<object> = [
  [{ ...tableView, objects: [] }, "INVALID_ARGUMENT objects"],
  [{ ...tableScene, depth: undefined }, "INVALID_ARGUMENT depth"],
  [inScene({ mask: undefined }), "INVALID_ARGUMENT objects[0].mask"],
  [inScene({ mask: undefined, label: 1 }), "INVALID_ARGUMENT objects[0].label"],
  [{ ...tableScene, labels: small }, "SIZE_MISMATCH labels"],
  [{ ...tableScene, occluders: [new Uint8Array(3)] }, "WRONG_LENGTH occluders[0]"],
  [{ ...tableScene, support: { normal: [0, 0, 0], d: 1 } }, "INVALID_ARGUMENT support.normal"],
];
refuses(scenes, (scene) => aligner.alignScene(scene as never, quick));

const sceneOptions: Refusals<object> = [
  [{ preset: "paper" }, "INVALID_OPTION options.preset"],
  [{ initial: poses[0] }, "UNKNOWN_OPTION options.initial"],
];
refuses(sceneOptions, (options) => aligner.alignScene(tableScene, options as never));

const still = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
const { mesh: _, ...frame } = input;
const views: Refusals<object> = [
  [{ views: undefined }, "INVALID_ARGUMENT views"],
  [{ views: [frame, { ...frame, depht: 1 }] }, "INVALID_ARGUMENT views[1].depht"],
  [{ views: [frame, { ...frame, depth: [1, 2] }] }, "INVALID_ARGUMENT views[1].depth"],
  [{ views: [{ ...frame, cameraToWorld: { ...still, scale: 2 } }] }, "INVALID_TRANSFORM views[0].cameraToWorld"],
  [{ views: [frame], depth: 1 }, "INVALID_ARGUMENT input.depth"],
];
refuses(views, (change) => aligner.alignViews({ mesh, ...change } as never));

test("no input at all", async () => {
  for (const nothing of [undefined, null, 5, "case", []]) {
    await rejectsWith(() => aligner.align(nothing as never), "INVALID_ARGUMENT input", /depth, mask, mesh, camera/);
  }
});

test("memory that is detached, functions, and proxies, with and without workers", async () => {
  const detached = structuredClone(depth);
  structuredClone(detached, { transfer: [detached.buffer] });
  using pool = await createAligner({ workers: 1 });
  for (const one of [aligner, pool]) {
    await rejectsWith(() => one.align({ ...input, depth: detached }), "INVALID_ARGUMENT depth", /detached.*transfer/);
    await rejectsWith(() => one.align({ ...input, mesh: (() => mesh) as never }), "INVALID_ARGUMENT mesh");
    const reactive = new Proxy(input, { get: (target, name) => Reflect.get(target, name) });
    assert.deepEqual(withoutTimes(await one.align(reactive, quick)), expected, "a forwarding proxy is its target");
  }
});

/** What a program may pass by mistake. */
const junk: readonly (() => unknown)[] = [
  ...[undefined, null, 5, Number.NaN, "junk", true].map((value) => () => value),
  ...[() => ({}), () => [], () => [[], null], () => new Uint8Array(3)],
  () => {
    const detached = new Float32Array(3);
    structuredClone(detached, { transfer: [detached.buffer] });
    return detached;
  },
];

/** A value with one of its parts, or the whole, replaced; the paths of parts up to some levels. */
function* damaged(value: unknown, levels: number): Generator<[where: string, make: () => unknown]> {
  for (const [i, make] of junk.entries()) yield [` as junk ${i}`, make];
  if (levels === 0 || typeof value !== "object" || value === null || ArrayBuffer.isView(value)) return;
  for (const [name, part] of Object.entries(value)) {
    const withPart = (other: unknown) =>
      Array.isArray(value) ? value.map((item, i) => (`${i}` === name ? other : item)) : { ...value, [name]: other };
    for (const [where, make] of damaged(part, levels - 1)) yield [`.${name}${where}`, () => withPart(make())];
    if (Number(name) >= 3) return;
  }
}

for (const [entry, exported] of Object.entries(entries)) {
  const isFunction = (name: string) => typeof exported[name] === "function" && name !== "Sim3AlignError";
  test(`each function of sim3align/${entry} refuses bad arguments by name, or takes them`, async () => {
    const calls = helperCalls[entry] ?? {};
    assert.deepEqual(Object.keys(calls).sort(), Object.keys(exported).filter(isFunction).sort(), "a call of each");
    for (const [name, valid] of Object.entries(calls)) {
      const call = exported[name] as (...args: unknown[]) => unknown;
      const attempt = async (args: readonly unknown[], what: string) => {
        try {
          await call(...args);
          return undefined;
        } catch (error) {
          assert.ok(
            error instanceof Sim3AlignError,
            `${name}, ${what}: ${error instanceof Error ? error.stack : error}`,
          );
          const { argument, found, expected, code } = error;
          assert.ok(argument && found && expected && code !== "INTERNAL", `${name}, ${what}: ${error.message}`);
          return error;
        }
      };
      assert.equal((await attempt(valid, "valid"))?.message, undefined, name);
      for (const [i, value] of valid.entries()) {
        for (const [where, make] of damaged(value, 3)) {
          const args = valid.map((other, k) => (k === i ? make() : other));
          await attempt(args, `argument ${i}${where}`);
        }
      }
    }
  });
}

test("an option that no helper function has is refused by name", async () => {
  const withOptions = [
    ...["bopSymmetries", "exportGlb", "exportSceneGlb", "fromBop", "fromSam3d", "orientedBoundingBox"],
    ...["placeSplats", "toBop", "toCocoRle", "toCuboid", "toSam3d", "uprightMesh"],
    ...["simulatorScene", "applyToObject3D", "meshInputFromThree", "transformFromObject3D"],
    ...["readCamera", "readCase", "readDepth", "readFrames", "readMesh", "readSam3d", "readScene"],
  ];
  for (const name of withOptions) {
    const [entry = ""] = Object.entries(helperCalls).find(([, calls]) => name in calls) ?? [];
    const args = helperCalls[entry]?.[name] ?? [];
    const options = { ...(args.at(-1) as object), nonsense: 1 };
    const call = entries[entry]?.[name] as (...args: unknown[]) => unknown;
    await rejectsWith(() => call(...args.slice(0, -1), options), "UNKNOWN_OPTION options.nonsense", /unknown/);
  }
});
