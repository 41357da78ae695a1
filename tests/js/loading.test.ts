/** What the installed package loads: its files, and its WebAssembly modules, each in a fresh process. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { createAligner, PreparedMesh, Sim3AlignError } from "sim3align";
import { toSim3 } from "sim3align/conventions";
import * as inline from "sim3align/inline";
import { installDir, repository } from "../support/environment.js";
import { rejectsWith } from "../support/errors.js";
import { obj } from "../support/files.js";
import { withoutTimes } from "../support/results.js";
import { input, mesh } from "../support/scene.js";

const require = createRequire(import.meta.url);
const coreWasm = require.resolve("sim3align/wasm/core_bg.wasm");
const fixtures = join(repository, "tests", "fixtures");

/** Runs a module with the package installed, and returns what it prints. */
function inFreshProcess(script: string): string {
  const prelude = `
    import assert from "node:assert/strict";
    import { readFileSync } from "node:fs";
    const compiled = [];
    const { compile } = WebAssembly;
    // Node's own modules are small.
    WebAssembly.compile = (bytes) => (bytes.byteLength > 50_000 && compiled.push(bytes.byteLength), compile(bytes));
    const path = ${JSON.stringify(coreWasm)};
    const cloud = Float64Array.of(0,0,0, 1,0,0, 0,1,0, 0,0,1);
    const pairs = Uint32Array.of(0,0, 1,1, 2,2, 3,3);
    const check = async (aligner) => assert.match(aligner.version, /^\\d/);
    const estimate = async (aligner) => {
      const { scale } = await aligner.estimateSim3(cloud, cloud.map((x) => 2 * x), pairs);
      assert.ok(Math.abs(scale - 2) < 1e-9);
    };
    const mask = { size: [2, 2], counts: [0, 4] };
    const tetrahedron = { positions: Float32Array.from(cloud), indices: Uint32Array.of(0, 1, 2, 0, 1, 3) };
    const view = { depth: { data: Float32Array.of(1, 1.1, 1.2, 1), width: 2, height: 2 }, cameraFile: '{ "fovYDeg": 50 }' };
    const parsed = { ...view, mask, mesh: tetrahedron };
    const camera = { fovYDeg: 50 };
    const bad = { depth: new Uint8Array(3), mask: new Uint8Array(3), camera, mesh: new Uint8Array(3) };
  `;
  const args = ["--input-type=module", "--eval", prelude + script];
  return execFileSync(process.execPath, args, { cwd: installDir, encoding: "utf8" });
}

const entry = `const { createAligner, Sim3AlignError } = await import("sim3align");`;

test("importing an entry loads nothing, prints nothing, starts nothing, and touches no browser globals", () => {
  const names = ["window", "document", "self", "location", "localStorage", "Worker", "HTMLElement", "customElements"];
  for (const name of ["", "/inline", "/formats", "/conventions", "/simulators", "/element"]) {
    const output = inFreshProcess(`
      const touched = new Set();
      for (const name of ${JSON.stringify(names)}) {
        Object.defineProperty(globalThis, name, {
          configurable: true,
          get() {
            const [, , caller = ""] = (new Error().stack ?? "").split("\\n");
            if (/node_modules\\/sim3align\\/(?!element)/.test(caller)) touched.add(name);
            return undefined;
          },
        });
      }
      const module = await import("sim3align${name}");
      const running = process.getActiveResourcesInfo().filter((one) => /Worker|MessagePort|Timeout/.test(one));
      assert.deepEqual([[...touched], compiled, running], [[], [], []]);
      console.log(Object.keys(module).length > 0);
    `);
    assert.equal(output, "true\n", name);
  }
});

test("each module loads once, when it is needed, however many calls need it at once", () => {
  const output = inFreshProcess(`
    ${entry}
    const { readDepth, readMesh } = await import("sim3align/formats");
    const aligners = await Promise.all([createAligner(), createAligner(), createAligner()]);
    await Promise.all(aligners.map(check));
    for (const form of [mask, new TextEncoder().encode(JSON.stringify(mask))]) {
      await assert.rejects(aligners[0].align({ ...parsed, mask: form }), { code: "TOO_FEW_POINTS" });
    }
    const counts = [compiled.length];
    await Promise.all(aligners.map((aligner) => assert.rejects(aligner.align(bad), { code: "UNSUPPORTED_FORMAT" })));
    counts.push(compiled.length);
    await Promise.all(aligners.map(estimate));
    await assert.rejects(aligners[0].align(parsed, { preset: "paper" }), { code: "TOO_FEW_POINTS" });
    counts.push(compiled.length);
    await assert.rejects(aligners[0].alignViews({ mesh: tetrahedron, views: [{ ...view, mask }] }), { code: "TOO_FEW_POINTS" });
    await Promise.all(aligners.map((aligner) => aligner.alignScene({ ...view, objects: [{ mask, mesh: tetrahedron }] })));
    (await aligners[1].track(tetrahedron)).dispose();
    counts.push(compiled.length);
    for (let i = 0; i < 2; i++) await readDepth(readFileSync(${JSON.stringify(join(fixtures, "depth-da3.npz"))}));
    counts.push(compiled.length);
    for (let i = 0; i < 2; i++) await readMesh(readFileSync(${JSON.stringify(join(fixtures, "splat.ply"))}));
    console.log([...counts, compiled.length].join());
  `);
  // The core; readers of files; registration; scenes, views and videos; files of depth models; splats.
  assert.equal(output, "1,2,3,4,5,6\n");
});

test("the core can come from every kind of source, and all modules from a folder", () => {
  const folder = JSON.stringify(pathToFileURL(dirname(coreWasm)).href);
  const sources = [
    `{ core: new URL("file://" + path) }`,
    `{ core: new URL("file://" + path).href }`,
    "{ core: readFileSync(path) }",
    // Node pools small reads in one ArrayBuffer, but not files of this size.
    "{ core: readFileSync(path).buffer.slice(0) }",
    "{ core: new WebAssembly.Module(readFileSync(path)) }",
    `{ core: new Response(readFileSync(path), { headers: { "content-type": "application/wasm" } }) }`,
    `{ core: "data:application/wasm;base64," + readFileSync(path).toString("base64") }`,
    `new URL(${folder})`,
    `${folder} + "/"`,
  ];
  for (const wasm of sources) {
    const script = `${entry} const aligner = await createAligner({ wasm: ${wasm} }); await check(aligner); await estimate(aligner);`;
    assert.equal(inFreshProcess(script), "", wasm);
  }
});

test("a failed load says what to do, and the next one tries again", () => {
  const output = inFreshProcess(`
    ${entry}
    const missing = new URL("file:///nowhere/core_bg.wasm");
    for (const wasm of [{ core: missing }, "file:///nowhere"]) {
      const message = /ENOENT.*core_bg\\.wasm/;
      await assert.rejects(createAligner({ wasm }), { name: "Sim3AlignError", code: "NOT_INITIALISED", argument: "wasm.core", message });
    }
    for (const core of [new Uint8Array(8), "http://127.0.0.1:9/core_bg.wasm"]) {
      await assert.rejects(createAligner({ wasm: { core } }), { code: "NOT_INITIALISED" });
    }
    const npz = readFileSync(${JSON.stringify(join(fixtures, "depth-da3.npz"))});
    const splat = readFileSync(${JSON.stringify(join(fixtures, "splat.ply"))});
    const calls = {
      formats: (aligner) => assert.rejects(aligner.align(bad), { code: "UNSUPPORTED_FORMAT" }),
      registration: estimate,
      joint: async (aligner) => (await aligner.track(tetrahedron)).dispose(),
      depthFiles: (aligner) => assert.rejects(aligner.align({ ...bad, depth: npz }), { code: /^(?!NOT_INITIALISED)/ }),
      splats: (aligner) => assert.rejects(aligner.align({ ...parsed, mesh: splat }), { code: "TOO_FEW_POINTS" }),
    };
    const aligner = await createAligner();
    for (const [name, call] of Object.entries(calls)) {
      const failing = await createAligner({ wasm: { [name]: missing } });
      const failed = await call(failing).then(() => "it loads", (error) => error.actual ?? error);
      assert.deepEqual([failed.code, failed.argument], ["NOT_INITIALISED", "wasm." + name], String(failed));
      await call(aligner);
    }
    console.log("done");
  `);
  assert.equal(output, "done\n");
});

test("inline: the same bits, with workers and without", async () => {
  const quick = { quality: "fast" } as const;
  const expected = withoutTimes(await (await createAligner()).align(input, quick));
  for (const workers of [0, 1]) {
    const aligner = await inline.createAligner({ workers });
    for (const one of [input, { ...input, mesh: obj(mesh) }]) {
      assert.deepEqual(withoutTimes(await aligner.align(one, quick)), expected);
    }
    await assert.rejects(aligner.align(input, { search: "local" }), (error) => error instanceof inline.Sim3AlignError);
    aligner.dispose();
  }
});

test("inline: a module that it does not embed is named, with the remedy", async () => {
  for (const workers of [0, 1]) {
    using aligner = await inline.createAligner({ workers });
    const call = () => aligner.estimateSim3(Float64Array.of(), Float64Array.of(), Uint32Array.of());
    await rejectsWith(call, "NOT_INITIALISED wasm.registration", /registration_bg\.wasm.*wasm: \{ registration \}/);
  }
});

test("errors and prepared meshes of one copy of the package are known to the other", async () => {
  const thrown = await (async () => toSim3(5 as never))().catch((error: unknown) => error);
  for (const Known of [Sim3AlignError, inline.Sim3AlignError, Error]) assert.ok(thrown instanceof Known);
  assert.notEqual(Sim3AlignError, inline.Sim3AlignError);
  class Special extends Sim3AlignError {}
  for (const other of [new Error("5"), null, "5", {}]) assert.ok(!(other instanceof Sim3AlignError));
  assert.ok(!(thrown instanceof Special) && new Special(thrown as Sim3AlignError) instanceof Special);
  using one = await createAligner();
  using other = await inline.createAligner();
  using prepared = await other.prepareMesh(mesh);
  assert.ok(prepared instanceof PreparedMesh && !((await one.align(input)) instanceof PreparedMesh));
  await rejectsWith(() => one.align({ ...input, mesh: prepared }), "INVALID_ARGUMENT mesh", /another copy.*one entry/);
});

test("what an entry imports is in the package: no three.js, and no other package", () => {
  for (const entry of ["sim3align", "sim3align/conventions", "sim3align/three", "sim3align/formats"]) {
    const loaded = new Set([require.resolve(entry)]);
    for (const file of loaded) {
      // Whatever their spaces: scripts are minified.
      const imports = /(?:^|[;}])(?:import|export)\b(?:[^;"()]*\bfrom)?\s*"([^"]+)"/gm;
      for (const [, name = ""] of readFileSync(file, "utf8").matchAll(imports)) {
        assert.match(name, /^\.{1,2}\//, file);
        loaded.add(join(dirname(file), name));
      }
    }
    assert.ok(loaded.size > 1, entry);
  }
});

test("what is not exported stays private", () => {
  assert.throws(() => require.resolve("sim3align/cli/main.js"), { code: "ERR_PACKAGE_PATH_NOT_EXPORTED" });
});
