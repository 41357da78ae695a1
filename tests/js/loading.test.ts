/** Loading of the WebAssembly modules, each in a fresh process. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { createAligner } from "sim3align";
import { installDir } from "../support/environment.js";
import { sourceModule } from "../support/internals.js";
import { input, truth } from "../support/scene.js";

const require = createRequire(import.meta.url);
const coreWasm = require.resolve("sim3align/wasm/core_bg.wasm");

/** Runs a module with the package installed, and returns what it prints. */
function inFreshProcess(script: string): string {
  const prelude = `
    import assert from "node:assert/strict";
    import { readFileSync } from "node:fs";
    import { createAligner, Sim3AlignError } from "sim3align";
    const path = ${JSON.stringify(coreWasm)};
    const cloud = Float64Array.of(0,0,0, 1,0,0, 0,1,0, 0,0,1);
    const pairs = Uint32Array.of(0,0, 1,1, 2,2, 3,3);
    const check = async (aligner) => assert.match(aligner.version, /^\\d/);
    const estimate = async (aligner) => {
      const { scale } = await aligner.estimateSim3(cloud, cloud.map((x) => 2 * x), pairs);
      assert.ok(Math.abs(scale - 2) < 1e-9);
    };
  `;
  return execFileSync(process.execPath, ["--input-type=module", "--eval", prelude + script], {
    cwd: installDir,
    encoding: "utf8",
    stdio: ["ignore", "pipe", "pipe"],
  });
}

test("the core loads once, however many ask at once; the other modules only when they are needed", () => {
  const output = inFreshProcess(`
    const compiled = [];
    const { compile } = WebAssembly;
    WebAssembly.compile = (source) => {
      // Node's own modules are small.
      if (source.byteLength > 50_000) compiled.push(source.byteLength);
      return compile(source);
    };
    const aligners = await Promise.all([createAligner(), createAligner(), createAligner()]);
    await Promise.all(aligners.map(check));
    assert.equal(compiled.length, 1);
    const mask = { size: [2, 2], counts: [0, 4] };
    const parsed = {
      depth: { data: Float32Array.of(1, 1.1, 1.2, 1), width: 2, height: 2 },
      mask: new TextEncoder().encode(JSON.stringify(mask)),
      cameraFile: '{ "fovYDeg": 50 }',
      mesh: { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), indices: Uint32Array.of(0, 1, 2, 0, 1, 3) },
    };
    for (const input of [parsed, { ...parsed, mask }]) {
      await assert.rejects(aligners[0].align(input), { code: "TOO_FEW_POINTS" });
    }
    assert.equal(compiled.length, 1, "JSON formats need no file readers");
    const bad = { depth: new Uint8Array(3), mask: new Uint8Array(3), camera: { fovYDeg: 50 }, mesh: new Uint8Array(3) };
    for (const aligner of aligners) await aligner.align(bad).catch((error) => assert.equal(error.code, "UNSUPPORTED_FORMAT"));
    assert.equal(compiled.length, 2);
    await Promise.all(aligners.map(estimate));
    assert.equal(compiled.length, 3);
    await assert.rejects(aligners[0].align({ ...parsed, mask }, { preset: "paper" }), { code: "TOO_FEW_POINTS" });
    assert.equal(compiled.length, 3);
    const { mesh, mask: _, ...view } = parsed;
    const alone = aligners[0].alignViews({ mesh, views: [{ ...view, mask }] });
    const joint = [alone, ...aligners.map((aligner) => aligner.alignScene({ ...view, objects: [{ mask, mesh }] }))];
    for (const { status, value, reason } of await Promise.allSettled(joint)) {
      assert.equal((status === "fulfilled" ? value.objects[0].error : reason).code, "TOO_FEW_POINTS");
    }
    (await aligners[1].track(mesh)).close();
    assert.equal(compiled.length, 4);
    console.log("done");
  `);
  assert.equal(output.trim(), "done");
});

const sources = {
  "a file URL": `new URL("file://" + path)`,
  "a file URL as text": `new URL("file://" + path).href`,
  bytes: "readFileSync(path)",
  "an ArrayBuffer": "readFileSync(path).buffer.slice(0)",
  "a module": "new WebAssembly.Module(readFileSync(path))",
  "a response": `new Response(readFileSync(path), { headers: { "content-type": "application/wasm" } })`,
  "a data URL": `"data:application/wasm;base64," + readFileSync(path).toString("base64")`,
};

for (const [name, source] of Object.entries(sources)) {
  test(`the core can come from ${name}`, () => {
    // Node pools small reads in one ArrayBuffer, but not files of this size.
    assert.equal(
      inFreshProcess(`await check(await createAligner({ wasm: { core: ${source} } })); console.log("done");`),
      "done\n",
    );
  });
}

const folder = JSON.stringify(pathToFileURL(dirname(coreWasm)).href);
for (const [name, wasm] of Object.entries({ "a URL": `new URL(${folder})`, text: `${folder} + "/"` })) {
  test(`all modules can come from a folder, as ${name}`, () => {
    const script = `const aligner = await createAligner({ wasm: ${wasm} }); await check(aligner); await estimate(aligner);`;
    assert.equal(inFreshProcess(`${script} console.log("done");`), "done\n");
  });
}

test("the source of one module is not taken for that of all", async () => {
  const empty = Uint8Array.of(0, 0x61, 0x73, 0x6d, 1, 0, 0, 0);
  for (const wasm of [
    new Uint8Array(8),
    new WebAssembly.Module(empty),
    new Response(empty),
    { formatsWasm: "x" },
    7,
    null,
  ]) {
    await assert.rejects(createAligner({ wasm: wasm as never }), { code: "INVALID_ARGUMENT", argument: "wasm" });
  }
});

test("a failed load says what to do, and the next one tries again", () => {
  const output = inFreshProcess(`
    const missing = new URL("file:///nowhere/core_bg.wasm");
    const failures = await Promise.allSettled([createAligner({ wasm: { core: missing } }), createAligner({ wasm: "file:///nowhere" })]);
    for (const { reason } of failures) {
      assert.ok(reason instanceof Sim3AlignError);
      assert.equal(reason.code, "NOT_INITIALISED");
      assert.equal(reason.argument, "wasm.core");
      assert.match(reason.message, /ENOENT.*core_bg\\.wasm/);
    }
    for (const core of [new Uint8Array(8), "http://127.0.0.1:9/core_bg.wasm"]) {
      await assert.rejects(createAligner({ wasm: { core } }), { code: "NOT_INITIALISED" });
    }
    const aligner = await createAligner();
    await check(aligner);
    const bad = await createAligner({ wasm: { formats: missing } });
    const files = { depth: new Uint8Array(3), mask: new Uint8Array(3), camera: { fovYDeg: 50 }, mesh: new Uint8Array(3) };
    await assert.rejects(bad.align(files), { code: "NOT_INITIALISED", argument: "wasm.formats" });
    await assert.rejects(aligner.align(files), { code: "UNSUPPORTED_FORMAT" });
    const other = await createAligner({ wasm: { registration: missing } });
    await assert.rejects(estimate(other), { code: "NOT_INITIALISED", argument: "wasm.registration" });
    await estimate(aligner);
    const mesh = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), indices: Uint32Array.of(0, 1, 2, 0, 1, 3) };
    const third = await createAligner({ wasm: { joint: missing } });
    await assert.rejects(third.track(mesh), { code: "NOT_INITIALISED", argument: "wasm.joint" });
    (await aligner.track(mesh)).close();
    console.log("done");
  `);
  assert.equal(output.trim(), "done");
});

test("loading prints nothing", () => {
  assert.equal(inFreshProcess("await check(await createAligner());"), "");
});

test("a trap in WebAssembly costs one call: the next one gets a new instance", async () => {
  // The package does not export its modules.
  const [{ createAligner }, { coreModule }] = [await sourceModule("index.js"), await sourceModule("core.js")];
  const aligner = await createAligner();
  const before = (await aligner.evaluate(input, truth)).metrics;
  const loaded = await coreModule.load();
  const trap = async () =>
    loaded.call(() => {
      // (module (func (export "f") unreachable)): what a panic in Rust ends in.
      const code = [
        0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0, 10, 5, 1, 3, 0, 0, 11,
      ];
      const { exports } = new WebAssembly.Instance(new WebAssembly.Module(Uint8Array.from(code)));
      (exports.f as () => void)();
    });
  const message = /RuntimeError: unreachable.*report/;
  await assert.rejects(trap, { name: "Sim3AlignError", code: "INTERNAL", argument: "sim3align", message });
  assert.deepEqual((await aligner.evaluate(input, truth)).metrics, before);
});

test("the build says its version", async () => {
  const { version } = JSON.parse(readFileSync(require.resolve("sim3align/package.json"), "utf8"));
  assert.equal((await createAligner()).version, version);
});
