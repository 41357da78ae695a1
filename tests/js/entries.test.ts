/** The package's other entries: everything in one piece, and the file readers alone. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdtempSync, readdirSync, readFileSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { createAligner } from "sim3align";
import { externalResources, readDepth, readMask, readMesh, Sim3AlignError } from "sim3align/formats";
import * as inline from "sim3align/inline";
import { cocoRle, gltfJson, npy, obj, png } from "../support/files.js";
import { input, mesh } from "../support/scene.js";
import { withoutTimes } from "../support/workers.js";

const quick = { quality: "fast" } as const;

test("inline: the same bits, with workers and without", async () => {
  const expected = withoutTimes(await (await createAligner()).align(input, quick));
  for (const workers of [0, 1]) {
    const aligner = await inline.createAligner({ workers });
    assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
    const file = { ...input, mesh: obj(mesh) };
    assert.ok((await aligner.align(file, quick)).scale > 0);
    await assert.rejects(aligner.align(input, { search: "local" }), (error) => error instanceof inline.Sim3AlignError);
    aligner.dispose();
  }
});

test("inline: no file is needed beside its own scripts", () => {
  const from = dirname(fileURLToPath(import.meta.resolve("sim3align/inline")));
  const folder = mkdtempSync(join(tmpdir(), "sim3align-inline-"));
  cpSync(join(from, "inline.js"), join(folder, "inline.mjs"));
  cpSync(join(from, "inline"), join(folder, "inline"), { recursive: true });
  const script = `
    import { createAligner } from ${JSON.stringify(join(folder, "inline.mjs"))};
    const cloud = Float64Array.of(0,0,0, 1,0,0, 0,1,0, 0,0,1);
    const pairs = Uint32Array.of(0,0, 1,1, 2,2, 3,3);
    for (const workers of [0, 1]) {
      using_(await createAligner({ workers }));
    }
    async function using_(aligner) {
      const { scale } = await aligner.estimateSim3(cloud, cloud.map((x) => 2 * x), pairs);
      console.log(scale.toFixed(6));
    }
  `;
  const output = execFileSync(process.execPath, ["--input-type=module", "--eval", script], { encoding: "utf8" });
  assert.equal(output, "2.000000\n2.000000\n");
});

test("formats: what the files hold", async () => {
  const { depth, mask, width, height } = input;
  const read = await readDepth(npy(depth, height, width));
  assert.deepEqual([read.width, read.height], [width, height]);
  assert.deepEqual(read.data, depth);
  const whole = await readDepth(png(Uint16Array.of(0, 1000, 2000, 4), 2, 2), { depthScale: 0.002 });
  assert.deepEqual(
    Array.from(whole.data, (z) => Math.round(1000 * z)),
    [0, 2000, 4000, 8],
  );
  const inTenths = await readDepth(png(Uint16Array.of(0, 1, 2, 3), 2, 2), { integerDepthScale: 0.1 });
  assert.equal(inTenths.data[2], Math.fround(0.2));
  for (const file of [npy(mask, height, width), png(mask, width, height), cocoRle(mask, width, height)]) {
    assert.deepEqual((await readMask(file)).data, mask);
  }
  const { positions, indices } = await readMesh(obj(mesh), { format: "obj" });
  assert.deepEqual(indices, mesh.indices);
  assert.equal(positions.length, mesh.positions.length);
  const gltf = Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "a%20b.bin" })));
  assert.deepEqual(await externalResources(gltf), { shape: ["a%20b.bin"], colors: [] });
  await assert.rejects(readMesh(Uint8Array.of(1, 2, 3)), (error) => error instanceof Sim3AlignError);
  await assert.rejects(readDepth("depth.npy" as never), { code: "INVALID_ARGUMENT", argument: "file" });
});

test("formats: loads nothing but the readers, and says when it can't", () => {
  const script = `
    import assert from "node:assert/strict";
    import { loadFormats, readMesh } from "sim3align/formats";
    const sizes = [];
    const { compile } = WebAssembly;
    // Node's own modules are small.
    WebAssembly.compile = (bytes) => (bytes.byteLength > 50_000 && sizes.push(bytes.byteLength), compile(bytes));
    await assert.rejects(loadFormats("file:///nowhere.wasm"), { code: "NOT_INITIALISED", argument: "wasm.formats" });
    await Promise.all([loadFormats(), readMesh(Buffer.from("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n"), { format: "obj" })]);
    console.log(sizes.length);
  `;
  const output = execFileSync(process.execPath, ["--input-type=module", "--eval", script], { encoding: "utf8" });
  assert.equal(output, "1\n");
});

test("no entry runs anything when it is imported, and none waits at its top level", () => {
  const folder = dirname(fileURLToPath(import.meta.resolve("sim3align")));
  const scripts = readdirSync(folder, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".js"));
  assert.ok(scripts.includes("index.js") && scripts.includes("worker.js"));
  for (const name of ["index.js", "inline.js", "formats.js"]) {
    const output = execFileSync(
      process.execPath,
      [
        "--input-type=module",
        "--eval",
        `WebAssembly.compile = WebAssembly.instantiate = () => console.log("compiles"); await import(${JSON.stringify(join(folder, name))});`,
      ],
      { encoding: "utf8" },
    );
    assert.equal(output, "", name);
  }
  const awaits = scripts.filter((name) => statSync(join(folder, name)).size < 60_000);
  for (const name of awaits) {
    assert.doesNotMatch(readFileSync(join(folder, name), "utf8"), /^(const .*= )?await /m, name);
  }
});
