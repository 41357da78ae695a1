/** Every call settles, whatever becomes of its worker or its messages, and the pool works on. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { Worker } from "node:worker_threads";
import { type Aligner, createAligner } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { npy } from "../support/files.js";
import { input, mesh } from "../support/scene.js";
import { Gate, slowInput, type WatchedWorker, Workers, withoutTimes } from "../support/workers.js";

const here = await createAligner();
const quick = { quality: "fast" } as const;
const expected = withoutTimes(await here.align(input, quick));
const aligners: Aligner[] = [];
after(() => {
  for (const aligner of aligners) aligner.dispose();
});

type Message = { type: string; job?: object; id?: number };
type Post = (message: Message, transfer: ArrayBuffer[]) => void;

/** A pool of one worker, whose messages go through `send`. */
async function poolWith(
  send: (message: Message, transfer: ArrayBuffer[], post: Post, worker: WatchedWorker) => void,
): Promise<{ aligner: Aligner; workers: Workers }> {
  const workers = new Workers();
  const createWorker = () => {
    const worker = workers.create();
    const post = worker.postMessage.bind(worker) as Post;
    worker.postMessage = (message: Message, transfer: ArrayBuffer[]) => send(message, transfer, post, worker);
    return worker;
  };
  const aligner = await createAligner({ workers: 1, createWorker });
  aligners.push(aligner);
  return { aligner, workers };
}

/** Sends a message that Node takes without complaint, and that the receiver cannot read. */
function spoil(message: Message, post: Post): void {
  const array = new Uint8Array(8);
  structuredClone(array, { transfer: [array.buffer] });
  post({ ...message, array } as Message, [array.buffer]);
}

const works = async (aligner: Aligner) => assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);

for (const type of ["start", "job", "module"]) {
  test(`a message (${type}) that the worker cannot read: it is sent again, to a new worker`, async () => {
    let spoilt = 0;
    const { aligner, workers } = await poolWith((message, transfer, post) => {
      if (message.type === type && spoilt++ === 0) spoil(message, post);
      else post(message, transfer);
    });
    const file = { ...input, depth: npy(input.depth, 120, 160) };
    const fromFile = withoutTimes(await here.align(file, quick));
    assert.deepEqual(withoutTimes(await aligner.align(file, quick)), fromFile);
    assert.equal(workers.made.length, 2);
    await works(aligner);
    assert.equal(workers.made.length, 2);
  });
}

test("messages that no worker can read: the call fails, and the next one has a worker again", async () => {
  let isSpoilt = true;
  const { aligner } = await poolWith((message, transfer, post) => {
    if (isSpoilt && message.type === "job") spoil(message, post);
    else post(message, transfer);
  });
  await rejectsWith(
    () => aligner.align(input, quick),
    "WORKER_FAILED workers",
    /a message that the worker could not read/,
  );
  isSpoilt = false;
  await works(aligner);
});

test("an answer that cannot be read: the job is run again", async () => {
  const { aligner, workers } = await poolWith((message, transfer, post, worker) => {
    if (message.type === "job" && workers.made.length === 1) worker.emit("messageerror", new Error("unreadable"));
    else post(message, transfer);
  });
  await works(aligner);
  assert.equal(workers.made.length, 2);
});

for (const type of ["start", "job"]) {
  test(`a worker whose postMessage throws (${type}): the call does not depend on it`, async () => {
    let isBroken = true;
    const { aligner } = await poolWith((message, transfer, post) => {
      if (isBroken && message.type === type) throw new Error("out of memory");
      post(message, transfer);
    });
    const moved = structuredClone(input);
    const call = aligner.align(moved, { ...quick, transfer: true });
    if (type === "start") {
      await rejectsWith(() => call, "WORKER_FAILED workers", /out of memory/);
    } else {
      // What cannot be sent is aligned on the calling thread.
      const { input: back, ...result } = await call;
      assert.deepEqual(withoutTimes(result), expected);
      assert.equal(back, moved);
    }
    isBroken = false;
    await works(aligner);
  });
}

test("what cannot be sent is aligned on the calling thread, also after a tracker was closed", async () => {
  let isBroken = false;
  const { aligner } = await poolWith((message, transfer, post) => {
    if (isBroken && message.type === "job") throw new Error("out of memory");
    post(message, transfer);
  });
  (await aligner.track(mesh)).close();
  isBroken = true;
  await works(aligner);
});

test("a worker that cannot be told that a mesh is freed is replaced", async () => {
  let isBroken = false;
  const { aligner, workers } = await poolWith((message, transfer, post) => {
    if (isBroken && message.type === "drop-mesh") throw new Error("out of memory");
    post(message, transfer);
  });
  const prepared = await aligner.prepareMesh(mesh);
  isBroken = true;
  prepared.dispose();
  await works(aligner);
  assert.equal(workers.made.length, 2);
});

test("a worker that ends when a job comes: the job is run again", async () => {
  const { aligner, workers } = await poolWith((message, transfer, post, worker) => {
    if (message.type === "job" && workers.made.length === 1) worker.terminate();
    post(message, transfer);
  });
  await works(aligner);
  assert.equal(workers.made.length, 2);
});

test("arrays that were moved to a worker that is lost are lost: the call says so, and others go on", async () => {
  const { aligner, workers } = await poolWith((message, transfer, post) => post(message, transfer));
  const call = aligner.align(structuredClone(slowInput), { quality: "best", transfer: true, onProgress: () => {} });
  const next = aligner.align(input, quick);
  const worker = await workers.nth(0);
  await worker.isBusy;
  await worker.terminate();
  await rejectsWith(() => call, "WORKER_FAILED workers", /exit code/);
  assert.deepEqual(withoutTimes(await next), expected);
});

test("arrays that are moved while their call waits for a worker are refused by name", async () => {
  const { aligner } = await poolWith((message, transfer, post) => post(message, transfer));
  const first = aligner.align(input, quick);
  const moved = structuredClone(input);
  const waiting = aligner.align(moved, quick);
  structuredClone(moved.mask, { transfer: [moved.mask.buffer] });
  await rejectsWith(() => waiting, "INVALID_ARGUMENT mask", /detached/);
  assert.deepEqual(withoutTimes(await first), expected);
  await works(aligner);
});

const reason = new RangeError("stop");
/** Ends of a call, and the errors that it may get. */
const ends: [name: string, end: (aligner: Aligner, controller: AbortController) => void, errors: RegExp][] = [
  ["abort", (_, controller) => controller.abort(reason), /^RangeError/],
  ["dispose", (aligner) => aligner.dispose(), /disposed aligner/],
  [
    "abort, then dispose",
    (aligner, controller) => {
      controller.abort(reason);
      aligner.dispose();
    },
    /^RangeError|disposed aligner/,
  ],
  [
    "dispose, then abort",
    (aligner, controller) => {
      aligner.dispose();
      controller.abort(reason);
    },
    /^RangeError|disposed aligner/,
  ],
];
for (const [name, end, errors] of ends) {
  for (const isLost of [false, true]) {
    test(`${name}${isLost ? " in the turn in which the worker is lost" : " while the worker runs"}`, async () => {
      const { aligner, workers } = await poolWith((message, transfer, post) => post(message, transfer));
      const controller = new AbortController();
      const { signal } = controller;
      const begun = new Gate();
      const running = aligner.align(slowInput, { quality: "best", signal, onProgress: begun.open });
      const waiting = aligner.align(input, { ...quick, signal });
      await begun.opened;
      const worker = await workers.nth(0);
      if (isLost) {
        // The pool hears of it; before it does anything, the call is ended.
        worker.emit("exit", 1);
        queueMicrotask(() => end(aligner, controller));
      } else end(aligner, controller);
      for (const call of await Promise.allSettled([running, waiting])) {
        assert.match(String(call.status === "rejected" && call.reason), errors);
      }
      await worker.terminate();
      if (name === "abort") await works(aligner);
      // All workers end with the aligner; this keeps the process alive until they have.
      else for (const other of workers.made) await other.ended();
    });
  }
}

test("a prepared mesh is freed in the worker, if no call used it, and after a call that outlives it", async () => {
  const sent: string[] = [];
  let whenFormats = () => {};
  const { aligner } = await poolWith((message, transfer, post) => {
    sent.push(message.type);
    if (message.type === "module") whenFormats();
    post(message, transfer);
  });
  const unused = await aligner.prepareMesh(mesh);
  assert.deepEqual(sent.splice(0), ["start", "job"]);
  unused.dispose();
  assert.deepEqual(sent.splice(0), ["drop-mesh"]);

  const prepared = await aligner.prepareMesh(mesh);
  // The worker waits for the readers of files, and could hear of the end of the mesh before it uses the mesh.
  whenFormats = () => prepared.dispose();
  const call = aligner.align({ ...input, depth: npy(input.depth, 120, 160), mesh: prepared }, quick);
  const waiting = aligner.align({ ...input, mesh: prepared }, quick);
  assert.ok((await call).scale > 0);
  assert.deepEqual(withoutTimes(await waiting), expected);
  assert.deepEqual(sent.splice(0), ["job", "job", "module", "drop-mesh", "job", "drop-mesh"]);

  await assert.rejects(aligner.prepareMesh({ positions: new Float32Array(9) }), { code: "DEGENERATE_MESH" });
  assert.deepEqual(sent, ["job", "drop-mesh"], "a mesh that was refused");
});

for (const [name, script] of Object.entries({
  "says nothing": "",
  "answers with rubbish":
    "const { parentPort } = require('node:worker_threads'); parentPort.on('message', () => parentPort.postMessage('hello'));",
  "claims success":
    "const { parentPort } = require('node:worker_threads'); parentPort.on('message', () => parentPort.postMessage({ type: 'done', result: 42 }));",
})) {
  test(`a worker that ${name} is no worker of this package`, async () => {
    const createWorker = () =>
      new Worker(`require("node:worker_threads").parentPort.on("message", () => {}); {${script}}`, { eval: true });
    const aligner = await createAligner({
      workers: 1,
      createWorker,
      workerStartMs: name === "says nothing" ? 50 : 60_000,
    });
    aligners.push(aligner);
    const moved = structuredClone(input);
    await rejectsWith(
      () => aligner.align(moved, { ...quick, transfer: true }),
      "WORKER_FAILED workers",
      name === "says nothing" ? /no answer for 50 ms/ : /a message that worker.js does not send/,
    );
    // It got no arrays that it could lose.
    assert.ok(moved.depth.length > 0);
  });
}

test("options and arguments whose getters throw are errors with a code", async () => {
  const throwing = {
    get depth() {
      throw new Error("not now");
    },
  };
  const message = /a property that throws Error: not now/;
  await rejectsWith(() => createAligner(throwing as never), "INVALID_ARGUMENT options.depth", message);
  using tracker = await here.track(mesh);
  await rejectsWith(
    () =>
      tracker.correct({
        matrix: new Array(16).fill(1),
        get scale(): number {
          throw new Error("not now");
        },
      } as never),
    "INVALID_ARGUMENT pose.scale",
    message,
  );
  await rejectsWith(
    () => tracker.correct(new Float64Array(16), throwing as never),
    "INVALID_ARGUMENT frame",
    /the number of a frame/,
  );
});
