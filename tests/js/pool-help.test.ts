/** Long jobs share the pool: idle workers help, and whatever becomes of them changes no bit and loses no call. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { MessageChannel, type MessagePort } from "node:worker_threads";
import { type Aligner, createAligner } from "sim3align";
import { brick, input } from "../support/scene.js";
import { type WatchedWorker, Workers, withoutTimes } from "../support/workers.js";

/** All that must be the same, of any result. */
const bits = (result: unknown) => JSON.stringify(result, (key, value) => (key === "timingsMs" ? undefined : value));

const here = await createAligner();
const hard = { quality: "best" } as const;
const expected = withoutTimes(await here.align(brick, hard));
const aligners: Aligner[] = [];
after(() => {
  for (const aligner of aligners) aligner.dispose();
});

type Message = { type: string; mesh?: unknown; port?: MessagePort };

/** A pool whose workers have all started, and the messages that are sent to them. */
async function pool(
  size: number,
  seen: (message: Message, worker: WatchedWorker) => void = () => {},
): Promise<{ aligner: Aligner; workers: Workers; sent: Message[] }> {
  const workers = new Workers();
  const sent: Message[] = [];
  let isReady = false;
  const createWorker = () => {
    const worker = workers.create();
    const post = worker.postMessage.bind(worker);
    worker.postMessage = (message, transfer) => {
      post(message, transfer);
      if (!isReady) return;
      sent.push(message);
      seen(message, worker);
    };
    return worker;
  };
  const aligner = await createAligner({ workers: size, createWorker });
  aligners.push(aligner);
  await Promise.all(workers.made.map(() => aligner.align(input, { quality: "fast" })));
  isReady = true;
  return { aligner, workers, sent };
}

const count = (sent: readonly Message[], type: string) => sent.filter((message) => message.type === type).length;

test("every idle worker helps with a hard case, with the same bits", async () => {
  const { aligner, sent } = await pool(3);
  assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
  assert.deepEqual([count(sent, "help"), count(sent, "helper")], [2, 2], "two workers were idle");
  assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
});

test("the results of a helper arrive while the job runs", async () => {
  const workers = new Workers();
  let answers = 0;
  const createWorker = () => {
    const worker = workers.create();
    const post = worker.postMessage.bind(worker);
    worker.postMessage = (message, transfer) => {
      if (message.type !== "help") return post(message, transfer);
      // The messages pass through this thread.
      const there: MessagePort = message.port;
      const { port1, port2 } = new MessageChannel();
      there.on("message", (data) => port1.postMessage(data));
      port1.on("message", (data) => {
        // The first one says that it is ready.
        if (data.length > 3) answers += 1;
        there.postMessage(data);
      });
      post({ ...message, port: port2 }, [port2]);
    };
    return worker;
  };
  const aligner = await createAligner({ workers: 2, createWorker });
  aligners.push(aligner);
  // On a busy machine, a helper may be ready when the job is done.
  for (let i = 0; i < 20 && answers < 5; i++) {
    assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
  }
  assert.ok(answers >= 5, `${answers} answers`);
});

test("nobody helps with a quick case, nor where every worker has a job", async () => {
  const { aligner, sent } = await pool(2);
  await aligner.align(input, { quality: "fast" });
  assert.equal(count(sent, "help"), 0);
  const jobs = Array.from({ length: 4 }, () => aligner.align(brick, hard));
  await Promise.all(jobs.slice(0, 2));
  assert.equal(count(sent, "help"), 0, "two jobs wait");
  for (const found of await Promise.all(jobs)) assert.deepEqual(withoutTimes(found), expected);
});

test("a helper is called back for a job that waits", async () => {
  let more: Promise<unknown> | undefined;
  const { aligner, sent } = await pool(2, (message) => {
    if (message.type === "help") more ??= aligner.align(input, { quality: "fast" });
  });
  assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
  await more;
  assert.ok(count(sent, "stop-helping") > 0);
  assert.equal(count(sent, "job"), 2, "one of them in the worker that helped");
});

test("a helper that is killed does not lose the call", async () => {
  for (const delay of [0, 20]) {
    const { aligner, workers } = await pool(2, (message, worker) => {
      if (message.type === "help") setTimeout(() => worker.terminate(), delay);
    });
    assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
    assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
    assert.ok(workers.made.length > 2, "it was replaced");
  }
});

test("a worker that is killed while others help it: its job runs again", async () => {
  let isKilled = false;
  const { aligner } = await pool(3, (message, worker) => {
    if (message.type !== "helper" || isKilled) return;
    isKilled = true;
    setTimeout(() => worker.terminate(), 30);
  });
  assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
  assert.ok(isKilled);
});

test("a call that is aborted lets its helpers go", async () => {
  const controller = new AbortController();
  const { aligner, sent } = await pool(2, (message) => {
    if (message.type === "help") queueMicrotask(() => controller.abort());
  });
  await assert.rejects(aligner.align(brick, { ...hard, signal: controller.signal }), { name: "AbortError" });
  assert.equal(count(sent, "stop-helping"), 1);
  assert.deepEqual(withoutTimes(await aligner.align(brick, hard)), expected);
});

test("helpers have prepared meshes, which come to each once", async () => {
  const { aligner, sent } = await pool(2);
  const prepared = await aligner.prepareMesh(brick.mesh);
  const given = { ...brick, mesh: prepared };
  for (let i = 0; i < 4; i++) assert.deepEqual(withoutTimes(await aligner.align(given, hard)), expected);
  const meshes = sent.filter(({ type }) => type === "help").map((message) => message.mesh);
  assert.equal(meshes.length, 4);
  assert.ok(meshes.filter((mesh) => mesh !== undefined).length <= 1, "the other worker has prepared it");
  prepared.dispose();
});

test("views have helpers, too: several quick searches are long", async () => {
  const { mesh, ...view } = input;
  const views = { mesh, views: [view, view, view] };
  const alone = await here.alignViews(views, { quality: "fast" });
  const { aligner, sent } = await pool(2);
  const found = await aligner.alignViews(views, { quality: "fast" });
  assert.equal(bits(found), bits(alone));
  assert.ok(count(sent, "help") > 0);
});

test("the objects of a scene have helpers, too", async () => {
  const { mesh, mask, ...view } = brick;
  const scene = { ...view, objects: [{ mask, mesh }] };
  const alone = await here.alignScene(scene, hard);
  const { aligner, sent } = await pool(2);
  const found = await aligner.alignScene(scene, hard);
  assert.equal(bits(found), bits(alone));
  assert.ok(count(sent, "help") > 0);
});
