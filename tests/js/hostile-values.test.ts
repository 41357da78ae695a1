/**
 * Values that no type declaration excludes: detached, shrunk and shared memory, proxies, getters that throw or change,
 * symbols. Each gets a typed error that names it, or the result of the ordinary value; with workers and without.
 */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, type AlignOptions, createAligner, type ErrorCode, type Progress } from "sim3align";
import { depthFromTensor } from "sim3align/conventions";
import { readCamera, readCase, readDepth, readMask, readMesh, readPose, readSam3d, readScene } from "sim3align/formats";
import { rejectsWith } from "../support/errors.js";
import { glb, npy } from "../support/files.js";
import { input, mesh, truth, view } from "../support/scene.js";
import { withoutTimes } from "../support/workers.js";

const here = await createAligner();
const pool = await createAligner({ workers: 1 });
after(() => pool.dispose());
const aligners = [
  ["without workers", here],
  ["with a worker", pool],
] as const;

const quick = { quality: "fast" } as const;
const expected = withoutTimes(await here.align(input, quick));

/** The array after its memory was moved to another thread. */
function detached<T extends ArrayBufferView>(array: T): T {
  const copy = structuredClone(array);
  structuredClone(copy, { transfer: [copy.buffer as ArrayBuffer] });
  return copy;
}

/** The array on memory that was shrunk below it. */
function shrunk(array: Float32Array): Float32Array {
  const Resizable = ArrayBuffer as unknown as new (
    length: number,
    options: { maxByteLength: number },
  ) => ArrayBuffer & { resize(length: number): void };
  const buffer = new Resizable(array.byteLength, { maxByteLength: array.byteLength });
  const view = new Float32Array(buffer, 0, array.length);
  buffer.resize(8);
  return view;
}

const failure = new RangeError("not loaded yet");
/** An object whose property throws. */
const throwing = <T extends object>(object: T, name: string): T =>
  Object.defineProperty({ ...object }, name, {
    enumerable: true,
    get: () => {
      throw failure;
    },
  });

/** A proxy that forwards everything, as reactive libraries make them. */
const proxied = <T extends object>(object: T): T =>
  new Proxy(object, { get: (target, name) => Reflect.get(target, name) });
const plainProxy = <T extends object>(object: T): T => new Proxy(object, {});
const hostileProxy = (object: object) =>
  new Proxy(object, {
    get: () => {
      throw failure;
    },
  });
/** A proxy of an array whose prototype cannot be read. */
const hidden = new Proxy(new Uint8Array(8), {
  getPrototypeOf: () => {
    throw failure;
  },
});
const { proxy: revoked, revoke } = Proxy.revocable({}, {});
revoke();
const nested: unknown[] = [];
nested.push(nested);

/** A value, and its error; the code is `INVALID_ARGUMENT` unless stated. */
type Hostile = [name: string, change: object, argument: string, message: RegExp, code?: ErrorCode];
const hostile: Hostile[] = [
  ["detached depth", { depth: detached(input.depth) }, "depth", /Float32Array whose memory is detached.*transfer/],
  ["detached mask", { mask: detached(input.mask) }, "mask", /Uint8Array whose memory is detached/],
  [
    "detached depth in an object",
    { depth: { data: detached(input.depth), width: 160, height: 120 } },
    "depth.data",
    /detached/,
  ],
  ["detached positions", { mesh: { ...mesh, positions: detached(mesh.positions) } }, "mesh.positions", /detached/],
  ["detached indices", { mesh: { ...mesh, indices: detached(mesh.indices) } }, "mesh.indices", /Uint32Array whose/],
  ["a detached file", { mesh: detached(glb(mesh)) }, "mesh", /detached/],
  ["a detached buffer", { mesh: detached(Uint8Array.from(glb(mesh))).buffer }, "mesh", /ArrayBuffer whose memory/],
  ["a detached K", { camera: { K: detached(new Float64Array(9)) } }, "camera.K", /Float64Array whose/],
  ["detached depth in shrunk memory", { depth: shrunk(input.depth) }, "depth", /detached.*or shrunk/],
  ["a proxy of depth", { depth: proxied(input.depth) }, "depth", /a proxy of Float32Array.*itself/],
  ["a plain proxy of depth", { depth: plainProxy(input.depth) }, "depth", /a proxy of Float32Array/],
  [
    "a proxy of depth that says nothing",
    { depth: new Proxy(input.depth, { get: () => undefined }) },
    "depth",
    /found a proxy of typed array/,
  ],
  ["a proxy of depth that throws", { depth: hostileProxy(input.depth) }, "depth", /a proxy of/],
  ["a proxy of the mask", { mask: proxied(input.mask) }, "mask", /a proxy of Uint8Array/],
  ["a proxy of a buffer", { mesh: plainProxy(new ArrayBuffer(9)) }, "mesh", /a proxy of ArrayBuffer/],
  ["depth that is called a file", { mesh: { [Symbol.toStringTag]: "Uint8Array" } }, "mesh", /proxy|object/],
  [
    "a camera that is called something else",
    { camera: { [Symbol.toStringTag]: "AbortSignal", ...view.camera } },
    "camera",
    /found AbortSignal/,
  ],
  ["a revoked proxy", { mesh: revoked }, "mesh", /throws/],
  ["a getter that throws", throwing(input, "mask"), "mask", /throws RangeError: not loaded yet/],
  ["a getter of the mesh that throws", { mesh: throwing(mesh, "indices") }, "mesh.indices", /not loaded yet/],
  ["a width that is a symbol", { width: Symbol("w") }, "width", /symbol Symbol\(w\)/],
  ["a width that is a big integer", { width: 160n }, "width", /bigint 160/],
  ["a width that is an object", { width: { valueOf: () => 160 } }, "width", /object/],
  [
    "the width of an image that is a symbol",
    { depth: { data: input.depth, width: Symbol("w"), height: 120 } },
    "depth.width",
    /symbol/,
  ],
  [
    "the width of a camera that is a symbol",
    { camera: { ...view.camera, width: Symbol("w") } },
    "camera.width",
    /symbol/,
  ],
  ["K that contains itself", { camera: { K: nested } }, "camera.K", /found 1 numbers/, "WRONG_LENGTH"],
  ["a file that cannot be read", { mesh: unreadableFile() }, "mesh", /cannot be read/, "FILE_NOT_FOUND"],
];

/** A file of a browser that was removed after it was chosen. */
function unreadableFile(): Blob {
  const blob = new Blob(["glTF"]);
  blob.arrayBuffer = () => Promise.reject(new DOMException("A requested file could not be read", "NotReadableError"));
  return blob;
}

for (const [name, aligner] of aligners) {
  for (const [value, change, argument, message, code = "INVALID_ARGUMENT"] of hostile) {
    // A worker gets a copy of the file.
    if (name === "with a worker" && value === "a file that cannot be read") continue;
    // A spread would call the getters.
    const bad = Object.create(null, {
      ...Object.getOwnPropertyDescriptors(input),
      ...Object.getOwnPropertyDescriptors(change),
    }) as AlignInput;
    test(`${name}: ${value}`, () => rejectsWith(() => aligner.align(bad, quick), `${code} ${argument}`, message));
  }

  test(`${name}: arguments of other calls`, async () => {
    const cloud = detached(mesh.positions);
    await rejectsWith(() => aligner.register(cloud, mesh.positions), "INVALID_ARGUMENT source", /detached/);
    const pairs = detached(new Uint32Array(6));
    const estimate = () => aligner.estimateSim3(mesh.positions, mesh.positions, pairs);
    await rejectsWith(estimate, "INVALID_ARGUMENT correspondences", /detached/);
    await rejectsWith(
      () => aligner.prepareMesh({ ...mesh, positions: cloud }),
      "INVALID_ARGUMENT mesh.positions",
      /detached/,
    );
    await rejectsWith(() => aligner.align(detached(new Uint8Array(8)) as never), "INVALID_ARGUMENT input", /detached/);
    const matrix = detached(new Float64Array(16));
    await rejectsWith(() => aligner.evaluate(input, { matrix }), "INVALID_ARGUMENT transform.matrix", /detached/);
    await rejectsWith(
      () => aligner.evaluate(input, truth, { truth: matrix }),
      "INVALID_ARGUMENT options.truth",
      /detached/,
    );
    await rejectsWith(
      () => aligner.align(input, throwing({ ...quick }, "seed")),
      "INVALID_ARGUMENT options.seed",
      /not loaded yet/,
    );
    const signal = { [Symbol.toStringTag]: "AbortSignal", aborted: false } as unknown as AbortSignal;
    await rejectsWith(() => aligner.align(input, { signal }), "INVALID_ARGUMENT options.signal", /AbortSignal/);
  });

  test(`${name}: the cause of a getter's error is kept`, async () => {
    const call = aligner.align(throwing(input, "depth"));
    await assert.rejects(call, (error: Error) => error.cause === failure);
  });

  test(`${name}: a getter is called once, so that it cannot change its mind`, async () => {
    const calls: string[] = [];
    const names = Object.keys(input) as (keyof typeof input)[];
    const counted = {} as typeof input;
    for (const name of names) {
      Object.defineProperty(counted, name, {
        enumerable: true,
        get: () => {
          if (calls.includes(name)) return undefined;
          calls.push(name);
          return input[name];
        },
      });
    }
    assert.deepEqual(withoutTimes(await aligner.align(counted, quick)), expected);
    assert.deepEqual(calls.sort(), names.sort());
  });

  test(`${name}: reactive objects, instances of classes, shared and resizable memory give the same bits`, async () => {
    class Frame {
      readonly unrelated = undefined;
      get depth() {
        return input.depth;
      }
      get camera() {
        return proxied(input.camera);
      }
      get other() {
        return "not an argument";
      }
    }
    const { depth, camera, ...others } = input;
    const frame = Object.assign(new Frame(), others);
    delete (frame as { unrelated?: undefined }).unrelated;
    const shared = new Float32Array(new SharedArrayBuffer(depth.byteLength));
    shared.set(depth);
    const sharedFile = new Uint8Array(new SharedArrayBuffer(glb(mesh).length));
    sharedFile.set(glb(mesh));
    const sharedJson = new Uint8Array(new SharedArrayBuffer(JSON.stringify(camera).length));
    sharedJson.set(new TextEncoder().encode(JSON.stringify(camera)));
    const Resizable = ArrayBuffer as unknown as new (length: number, options: { maxByteLength: number }) => ArrayBuffer;
    const resizable = new Float32Array(new Resizable(depth.byteLength, { maxByteLength: 2 * depth.byteLength }));
    resizable.set(depth);
    const same: unknown[] = [
      proxied(input),
      { ...input, mesh: proxied(mesh), camera: plainProxy(camera) },
      { ...input, camera: proxied({ K: proxied([camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1]) }) },
      frame,
      Object.create(input),
      { ...input, depth: shared },
      { ...input, depth: resizable },
      { ...others, depth, cameraFile: sharedJson },
    ];
    for (const value of same) assert.deepEqual(withoutTimes(await aligner.align(value as AlignInput, quick)), expected);
    const fromFile = withoutTimes(await here.align({ ...input, mesh: glb(mesh) }, quick));
    assert.deepEqual(withoutTimes(await aligner.align({ ...input, mesh: sharedFile }, quick)), fromFile);
  });

  test(`${name}: alignAll refuses what is no list of inputs`, async () => {
    const drain = async (inputs: unknown, options = {}) => {
      for await (const _ of aligner.alignAll(inputs as AlignInput[], options)) assert.fail("no input");
    };
    const lists = [5, null, undefined, input, () => input, { [Symbol.iterator]: () => 5 }];
    const odd = [detached(new Uint8Array(8)), plainProxy(new Uint8Array(8)), hidden, revoked];
    for (const inputs of [...lists, ...odd]) {
      await rejectsWith(() => drain(inputs), "INVALID_ARGUMENT inputs", /iterable/);
    }
    const silent = { [Symbol.iterator]: () => ({ next: () => 5 }) };
    await rejectsWith(() => drain(silent), "INVALID_ARGUMENT inputs", /next\(\)/);
    await rejectsWith(() => drain([], { onProgress: "log" }), "INVALID_ARGUMENT options.onProgress", /function/);
  });

  test(`${name}: an async onProgress that rejects ends the call, and not the process`, async () => {
    let calls = 0;
    const onProgress = async (_: Progress) => {
      calls += 1;
      throw failure;
    };
    await assert.rejects(aligner.align(input, { ...quick, onProgress }), (error) => error === failure);
    const all = async () => {
      for await (const _ of aligner.alignAll([input], { ...quick, onProgress })) assert.fail("no result");
    };
    await assert.rejects(all, (error) => error === failure);
    assert.ok(calls >= 2);
    assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
  });

  test(`${name}: a promise of onProgress that rejects after the call is of no account`, async () => {
    const rejections: (() => void)[] = [];
    const onProgress = () => new Promise<void>((_, reject) => rejections.push(() => reject(failure)));
    assert.deepEqual(withoutTimes(await aligner.align(input, { ...quick, onProgress })), expected);
    for (const reject of rejections) reject();
    // An unhandled rejection would fail the test file.
    await new Promise((resolve) => setImmediate(resolve));
    assert.ok(rejections.length > 0);
  });
}

test("without workers: memory that goes while a file is read", async () => {
  const own = await createAligner();
  const moved = { ...input, depth: structuredClone(input.depth), mesh: glb(mesh) };
  const call = own.align(moved, quick);
  structuredClone(moved.depth, { transfer: [moved.depth.buffer as ArrayBuffer] });
  await rejectsWith(() => call, "INVALID_ARGUMENT depth", /detached/);
  const file = Uint8Array.from(npy(input.depth, 120, 160));
  const next = own.align({ ...input, depth: file }, { ...quick, signal: new AbortController().signal });
  structuredClone(file, { transfer: [file.buffer as ArrayBuffer] });
  await rejectsWith(() => next, "INVALID_ARGUMENT depth", /detached/);
});

test("a proxy of a prepared mesh is not called disposed", async () => {
  using prepared = await here.prepareMesh(mesh);
  const call = () => here.align({ ...input, mesh: proxied(prepared) }, quick);
  await rejectsWith(call, "INVALID_ARGUMENT mesh", /no proxy/);
});

test("createAligner refuses options that are none", async () => {
  const refused: [options: unknown, code: ErrorCode, argument: string, message: RegExp][] = [
    [null, "INVALID_ARGUMENT", "options", /null/],
    [4, "INVALID_ARGUMENT", "options", /number 4/],
    [{ worker: 2 }, "UNKNOWN_OPTION", "worker", /workers/],
    [{ workers: 1, createWorker: "worker.js" }, "INVALID_ARGUMENT", "createWorker", /function/],
  ];
  for (const [options, code, argument, message] of refused) {
    await rejectsWith(() => createAligner(options as object), `${code} ${argument}`, message);
  }
  const misplaced = { workers: 4 } as AlignOptions;
  await rejectsWith(
    () => here.align(input, misplaced),
    "UNKNOWN_OPTION options.workers",
    /option of createAligner.*createAligner\(\{ workers \}\)/,
  );
});

test("the readers of files refuse them, too", async () => {
  const refused: [call: () => Promise<unknown>, argument: string][] = [
    [() => readPose(revoked), "pose"],
    [() => readCamera(throwing({ ...view.camera }, "fx")), "camera.fx"],
    [() => readMask(detached(new Uint8Array(8))), "file"],
    [() => readDepth(plainProxy(new Uint8Array(8))), "file"],
    [() => readMesh(glb(mesh), null as never), "options"],
    [() => readCase(5 as never), "files"],
    [() => readScene(5 as never), "files"],
    [() => readSam3d(5 as never), "files"],
  ];
  for (const [call, argument] of refused) await rejectsWith(call, `INVALID_ARGUMENT ${argument}`);
});

test("a tracker refuses a pose that cannot be sent to its worker, and remains usable", async () => {
  for (const [name, aligner] of aligners) {
    using tracker = await aligner.track(mesh, { quality: "fast" });
    await tracker.next(view);
    for (const odd of [Symbol("odd"), () => 1]) {
      const inTranslation = { ...truth, translation: odd } as never;
      await rejectsWith(() => tracker.correct(inTranslation), "INVALID_ARGUMENT pose.translation");
      await rejectsWith(() => tracker.correct({ matrix: odd } as never), "INVALID_ARGUMENT pose");
    }
    assert.equal((await tracker.next(view)).frame, 1, name);
  }
});

test("a frame is tracked whatever else the mesh and its camera file hold", async () => {
  const { camera, ...rest } = view;
  const cameraFile = { ...camera, date: new Date(0), note: Symbol("odd"), parse: () => 1, list: [/x/] };
  for (const [name, aligner] of aligners) {
    using tracker = await aligner.track({ ...mesh, dispose() {} } as never, { quality: "fast" });
    const plain = await tracker.next(view);
    const found = await tracker.next({ ...rest, cameraFile } as never);
    assert.deepEqual([plain.frame, found.frame], [0, 1], name);
    await rejectsWith(() => tracker.next({ ...view, mask: Symbol("odd") } as never), "INVALID_ARGUMENT mask");
  }
});

test("numbers among which are revoked proxies and lists are refused", async () => {
  const cyclic: unknown[] = [];
  cyclic.push(cyclic, 1, 2, 3);
  for (const data of [[1, revoked, 2, 3], cyclic]) {
    await rejectsWith(async () => depthFromTensor({ data, dims: [2, 2] }), "INVALID_ARGUMENT tensor.data");
  }
});
