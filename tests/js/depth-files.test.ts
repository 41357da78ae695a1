/** Depth maps that the libraries of depth models wrote; `tests/fixtures/make_depth_files.py` says what is in each. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner, type PinholeCamera } from "sim3align";
import { type ReadDepthOptions, readDepth, Sim3AlignError } from "sim3align/formats";
import * as inline from "sim3align/inline";
import { repository } from "../support/environment.js";
import { npy, png } from "../support/files.js";
import { input } from "../support/scene.js";

/** What a file holds, or why it is refused. */
interface Expected {
  data: (number | null)[];
  width: number;
  height: number;
  unit: string;
  camera?: PinholeCamera;
  /** Of angles, whose functions differ in their last bits. */
  cameraTolerance?: number;
  options?: ReadDepthOptions;
  error?: { code: string; argument: string };
}

const python = process.env.SIM3ALIGN_DEPTH_FILES ?? "";
const skip =
  python === "" && "No Python with the packages of scripts/bench/depth-files/requirements.txt; see CONTRIBUTING.md.";

const fixtures = join(repository, "tests", "fixtures");
const fixture = (name: string) => new Uint8Array(readFileSync(join(fixtures, name)));

test("files of numpy, OpenCV, OpenEXR and tifffile: values, mask, camera and unit", { skip }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "sim3align-depth-"));
  execFileSync(python, [join(fixtures, "make_depth_files.py"), folder]);
  const all = JSON.parse(readFileSync(join(folder, "expected.json"), "utf8")) as Record<string, Expected>;
  assert.ok(Object.keys(all).length > 40);
  for (const [name, expected] of Object.entries(all)) {
    const file = new Uint8Array(readFileSync(join(folder, name)));
    const reading = readDepth(file, expected.options);
    if (expected.error !== undefined) {
      await assert.rejects(reading, expected.error, name);
      continue;
    }
    const { data, width, height, unit, camera } = await reading;
    assert.deepEqual([width, height, unit], [expected.width, expected.height, expected.unit], name);
    assert.deepEqual(
      data,
      Float32Array.from(expected.data, (z) => z ?? Number.NaN),
      name,
    );
    if (expected.cameraTolerance === undefined) assert.deepEqual(camera, expected.camera, name);
    else
      for (const [key, value] of Object.entries(expected.camera ?? {})) {
        const found = camera?.[key as keyof PinholeCamera] ?? Number.NaN;
        assert.ok(Math.abs(found / value - 1) <= expected.cameraTolerance, `${name}: ${key} ${found}, not ${value}`);
      }
  }
});

test("kinds of depth: what their values mean", async () => {
  const relative = { depthKind: "affine-invariant-disparity" } as const;
  const values = Float32Array.of(0, -2, Number.NaN, 0.5, Number.POSITIVE_INFINITY, 3);
  const file = npy(values, 2, 3);
  const read = async (options: ReadDepthOptions) => Array.from((await readDepth(file, options)).data);
  assert.deepEqual(await read({}), [0, 0, 0, 0.5, 0, 3]);
  assert.deepEqual(await read({ depthKind: "scale-invariant" }), [0, 0, 0, 0.5, 0, 3]);
  assert.deepEqual(await read({ depthKind: "scale-invariant", depthScale: 2 }), [0, 0, 0, 1, 0, 6]);
  for (const depthKind of ["affine-invariant", "affine-invariant-disparity"] as const) {
    assert.deepEqual(await read({ depthKind }), [0, -2, Number.NaN, 0.5, Number.NaN, 3]);
  }
  const picture = png(Uint8Array.of(0, 7, 255, 1), 2, 2);
  const { data, unit } = await readDepth(picture, relative);
  assert.deepEqual([...data, unit], [0, 7, 255, 1, "none (affine-invariant-disparity)"]);
  const eightBit = { code: "EIGHT_BIT_DEPTH", argument: "depth", message: /depthKind "affine-invariant-disparity"/ };
  await assert.rejects(readDepth(picture), eightBit);
  await assert.rejects(readDepth(picture, { depthKind: "scale-invariant" }), eightBit);
  const unknown = { code: "INVALID_OPTION", argument: "options.depthKind", message: /"scale-invariant"/ };
  for (const depthKind of ["relative", 7]) {
    await assert.rejects(readDepth(picture, { depthKind: depthKind as never }), unknown);
    await assert.rejects(readDepth(fixture("depth-da3.npz"), { depthKind: depthKind as never }), unknown);
  }
  assert.equal((await readDepth(png(Uint16Array.of(5, 6), 2, 1))).unit, "0.001 m (16-bit integers, assumed)");
  const inCamera = await readDepth(png(Uint16Array.of(5, 6), 2, 1), { integerDepthScale: 0.0001 });
  assert.equal(inCamera.unit, "0.0001 m (camera file)");
});

test("files cut at many lengths and changed at random are refused by code", async () => {
  const codes = new Set<string>();
  const attempt = async (name: string, file: Uint8Array) => {
    const error = await readDepth(file).then(
      () => undefined,
      (error: unknown) => error,
    );
    if (error === undefined) return false;
    assert.ok(error instanceof Sim3AlignError && error.code !== "INTERNAL", `${name}: ${error}`);
    codes.add(error.code);
    return true;
  };
  for (const name of ["depth-pro.npz", "moge.npz", "opencv.exr", "blender.exr", "float32.tiff", "opencv.pfm"]) {
    const whole = fixture(`depth-${name}`);
    assert.equal(await attempt(name, whole), false, name);
    for (let length = 4; length < whole.length; length += length < 400 ? 7 : 97) {
      const isRefused = await attempt(`${name} cut to ${length}`, whole.slice(0, length));
      // The names of a TIFF's last entries may follow its pixels.
      assert.ok(isRefused || name.endsWith(".tiff"), `${name} cut to ${length}`);
    }
    for (let seed = 1; seed <= 150; seed++) {
      const damaged = whole.slice();
      let state = seed;
      for (let i = 0; i < 4; i++) {
        state = (Math.imul(state, 1103515245) + 12345) >>> 0;
        damaged[4 + ((state >>> 8) % Math.min(damaged.length - 4, i < 2 ? 400 : damaged.length))] = state >>> 24;
      }
      await attempt(`${name}, seed ${seed}`, damaged);
    }
  }
  assert.ok(codes.has("CORRUPT_FILE"));
});

test("their bytes are the depth of align, in workers and in the inlined package", async () => {
  const depth = fixture("depth-depth-pro.npz");
  const { data, width, height } = await readDepth(depth);
  const mask = Uint8Array.from(data, (_, i) => (i % width > 8 && i % width < 30 && i / width > 4 ? 1 : 0));
  const camera = { fx: 41.5, fy: 41.5, cx: (width - 1) / 2, cy: (height - 1) / 2 };
  const options = { quality: "fast" } as const;
  const shared = { mask, camera, mesh: input.mesh };
  const expected = await (await createAligner()).align({ ...shared, depth: { data, width, height } }, options);
  for (const create of [createAligner, inline.createAligner]) {
    for (const workers of [0, 1]) {
      const aligner = await create({ workers });
      const { matrix } = await aligner.align({ ...shared, depth }, options);
      assert.deepEqual(matrix, expected.matrix);
      aligner.dispose();
    }
  }
});

test("the module of these files is loaded when one is passed, from where it is said to be", () => {
  const script = `
    import assert from "node:assert/strict";
    import { readFileSync } from "node:fs";
    import { createAligner } from "sim3align";
    import { readDepth } from "sim3align/formats";
    const sizes = [];
    const { compile } = WebAssembly;
    // Node's own modules are small.
    WebAssembly.compile = (bytes) => (bytes.byteLength > 50_000 && sizes.push(bytes.byteLength), compile(bytes));
    const npz = readFileSync(${JSON.stringify(join(fixtures, "depth-da3.npz"))});
    const aligner = await createAligner({ wasm: { depthFiles: "file:///nowhere.wasm" } });
    const camera = { fx: 1, fy: 1, cx: 0, cy: 0 };
    const failed = { code: "NOT_INITIALISED", argument: "wasm.depthFiles" };
    await assert.rejects(aligner.align({ depth: npz, camera, mask: new Uint8Array(1), mesh: {} }), failed);
    const before = sizes.length;
    await readDepth(npz);
    await readDepth(npz);
    console.log(sizes.length - before);
  `;
  const output = execFileSync(process.execPath, ["--input-type=module", "--eval", script], { encoding: "utf8" });
  assert.equal(output, "1\n");
});
