/** Workers in a browser: bit-identical results, cancelling, failing workers. */
import assert from "node:assert/strict";
import { before, test } from "node:test";
import type { Page } from "playwright-core";
import { createAligner } from "sim3align";
import { browserFor, WITHOUT_3D } from "../support/browser.js";
import { installDir } from "../support/environment.js";
import { input } from "../support/scene.js";

const browser = browserFor(installDir, WITHOUT_3D);
let page: Page;
before(async () => {
  ({ page } = await browser.open("node_modules/sim3align/package.json"));
});

/** Modules for the functions that run in the page. */
interface InPage {
  sim3align: typeof import("sim3align");
  scene: typeof import("../support/scene.js");
}

/** Runs a function in the page, with the installed package and the tests' scene. */
async function run<T>(work: (modules: InPage) => Promise<T>): Promise<T> {
  return page.evaluate(`(async () => {
    const sim3align = await import("/node_modules/sim3align/index.js");
    const scene = await import("/tests/support/scene.js");
    return (${String(work)})({ sim3align, scene });
  })()`) as Promise<T>;
}

test("results are bit-identical to those of Node, with and without workers", async () => {
  const { matrix } = await (await createAligner()).align(input);
  const found = await run(async ({ sim3align, scene }) => {
    const all: number[][] = [];
    for (const workers of [0, 1, 3]) {
      const aligner = await sim3align.createAligner({ workers });
      all.push(Array.from((await aligner.align(scene.input)).matrix));
      aligner.dispose();
    }
    return all;
  });
  for (const each of found) assert.deepEqual(each, Array.from(matrix));
});

test("an idle worker helps with a hard case, with the bits of Node", async () => {
  const { matrix } = await (await createAligner()).align(input, { quality: "best" });
  const { found, answers } = await run(async ({ sim3align, scene }) => {
    let answers = 0;
    const createWorker = () => {
      const worker = new Worker("/node_modules/sim3align/worker.js", { type: "module" });
      const post = worker.postMessage.bind(worker) as (message: unknown, transfer: Transferable[]) => void;
      worker.postMessage = (message: { type: string; port: MessagePort }, transfer: unknown) => {
        if (message.type !== "help") return post(message, transfer as Transferable[]);
        // The messages pass through this thread.
        const there = message.port;
        const { port1, port2 } = new MessageChannel();
        there.onmessage = ({ data }) => port1.postMessage(data);
        port1.onmessage = ({ data }) => {
          // The first one says that it is ready.
          if (data.length > 3) answers += 1;
          there.postMessage(data);
        };
        post({ ...message, port: port2 }, [port2]);
      };
      return worker;
    };
    const aligner = await sim3align.createAligner({ workers: 2, createWorker });
    const found: number[][] = [];
    // On a busy machine, a helper may be ready when the job is done.
    for (let i = 0; i < 20 && answers < 5; i++) {
      found.push(Array.from((await aligner.align(scene.input, { quality: "best" })).matrix));
    }
    aligner.dispose();
    return { found, answers };
  });
  for (const each of found) assert.deepEqual(each, Array.from(matrix));
  assert.ok(answers >= 5, `${answers} answers`);
});

test("aborting ends the job of a worker, errors keep their class, and progress is reported", async () => {
  const outcome = await run(async ({ sim3align, scene }) => {
    const aligner = await sim3align.createAligner({ workers: "auto" });
    const controller = new AbortController();
    const stages: string[] = [];
    const reason = await aligner
      .align(scene.input, {
        quality: "best",
        signal: controller.signal,
        onProgress: ({ stage }) => {
          stages.push(stage);
          controller.abort();
        },
      })
      .catch((error) => error.name);
    const error = await aligner.align(scene.input, { search: "local" }).catch((caught) => caught);
    const scale = (await aligner.align(scene.input, { quality: "fast" })).scale;
    aligner.dispose();
    const disposed = await aligner.align(scene.input).catch((caught) => caught.code);
    return { reason, stages, isOurs: error instanceof sim3align.Sim3AlignError, code: error.code, scale, disposed };
  });
  const { scale, ...rest } = outcome;
  assert.ok(scale > 0);
  assert.deepEqual(rest, {
    reason: "AbortError",
    stages: ["observe"],
    isOurs: true,
    code: "INVALID_OPTION",
    disposed: "DISPOSED",
  });
});

test("calls report workers that cannot be loaded or throw; a lost worker is replaced", async () => {
  const outcome = await run(async ({ sim3align, scene }) => {
    const codes: string[] = [];
    const scripts = ["/no-such-script.js", URL.createObjectURL(new Blob(["throw new Error('broken')"]))];
    for (const script of scripts) {
      const createWorker = () => new Worker(script, { type: "module" });
      const aligner = await sim3align.createAligner({ workers: 1, createWorker });
      codes.push(await aligner.align(scene.input).catch((error) => error.code));
      aligner.dispose();
    }
    // The first of these workers throws instead of running its job.
    let made = 0;
    const scriptOf = (code: string) => URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    const failing = scriptOf(`addEventListener("message", (event) => {
      if (event.data.type !== "job") return;
      event.stopImmediatePropagation();
      throw new Error("lost");
    });`);
    // Imported first, so that its listener precedes that of the package.
    const faulty = scriptOf(`import "${failing}"; import "${location.origin}/node_modules/sim3align/worker.js";`);
    const createWorker = () => {
      made += 1;
      return new Worker(made === 1 ? faulty : "/node_modules/sim3align/worker.js", { type: "module" });
    };
    const aligner = await sim3align.createAligner({ workers: 1, createWorker });
    const { scale } = await aligner.align(scene.input, { quality: "best" });
    aligner.dispose();
    return { codes, made, scale };
  });
  assert.deepEqual(outcome.codes, ["WORKER_FAILED", "WORKER_FAILED"]);
  assert.equal(outcome.made, 2);
  assert.ok(outcome.scale > 0);
});

test("sim3align/inline works in a sandbox without network access, with workers", { timeout: 120_000 }, async () => {
  const scale = await page.evaluate(async () => {
    const code = await (await fetch("/node_modules/sim3align/inline.js")).text();
    const frame = document.createElement("iframe");
    frame.sandbox.add("allow-scripts");
    const policy = "default-src 'none'; script-src 'unsafe-inline' blob: 'wasm-unsafe-eval'; worker-src blob:";
    frame.srcdoc = `
      <meta http-equiv="Content-Security-Policy" content="${policy}">
      <script type="module">
        const code = ${JSON.stringify(code).replaceAll("</script", "<\\/script")};
        const { createAligner } = await import(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
        const size = 48;
        const depth = new Float32Array(size * size).fill(1.3);
        const mask = new Uint8Array(size * size);
        for (let i = 0; i < depth.length; i++) {
          const [x, y] = [(i % size - 23.5) / 16, (Math.floor(i / size) - 23.5) / 13];
          if (x * x + y * y >= 1) continue;
          mask[i] = 1;
          depth[i] = 1 - 0.2 * (1 - Math.abs(x)) * (1 - Math.abs(y));
        }
        const positions = Float32Array.of(1,0,0, -1,0,0, 0,0.8,0, 0,-0.8,0, 0,0,0.6, 0,0,-0.6);
        const indices = Uint32Array.of(0,2,4, 2,1,4, 1,3,4, 3,0,4, 2,0,5, 1,2,5, 3,1,5, 0,3,5);
        const input = { depth, width: size, height: size, mask, camera: { fovYDeg: 50 }, mesh: { positions, indices } };
        createAligner({ workers: 1 })
          .then((aligner) => aligner.align(input, { quality: "fast" }))
          .then(({ scale }) => parent.postMessage(scale, "*"), (error) => parent.postMessage(String(error), "*"));
      </script>`;
    const answer = new Promise((resolve) => {
      addEventListener("message", ({ data }) => resolve(data), { once: true });
    });
    document.body.append(frame);
    return answer;
  });
  // Half the width of the mask, 16 of 48 pixels at a field of view of 50°, at a distance of a metre.
  assert.ok(typeof scale === "number" && scale > 0.2 && scale < 0.5, String(scale));
});
