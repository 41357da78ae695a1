/** 3D Gaussians as meshes, through the package. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { applyToPoints, placeSplats } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";
import { repository } from "../support/environment.js";
import { rejectsWith } from "../support/errors.js";
import { mesh, view } from "../support/scene.js";
import { splatOf, splatPly, splatRecords } from "../support/splats.js";

const fixtures = join(repository, "tests", "fixtures");
const { width, height, depth, mask, camera } = view;
const gaussians = splatOf(mesh, 20_000, 1);
const ply = splatPly(gaussians);

/** The angle between two rotations, degrees. */
const angle = (a: ArrayLike<number>, b: ArrayLike<number>) =>
  (360 / Math.PI) * Math.acos(Math.min(1, Math.abs(Array.from(a).reduce((sum, x, i) => sum + x * (b[i] ?? 0), 0))));

test("a splat is aligned where the mesh of the same object is, with and without workers", async () => {
  const input = { depth, width, height, mask, camera };
  const aligner = await createAligner();
  const expected = await aligner.align({ ...input, mesh });
  const pool = await createAligner({ workers: 1 });
  const results = [
    await aligner.align({ ...input, mesh: ply }),
    await pool.align({ ...input, mesh: splatRecords(gaussians) }),
  ];
  results.push(await pool.align({ ...input, mesh: { bytes: splatRecords(gaussians), format: "splat" } }));
  await pool.dispose();
  for (const found of results) {
    assert.ok(Math.abs(found.scale / expected.scale - 1) < 0.01, `scale ${found.scale} of ${expected.scale}`);
    assert.ok(angle(found.rotation, expected.rotation) < 2, `${found.rotation} of ${expected.rotation}`);
    const [a, b] = [found, expected].map((pose) => applyToPoints(pose, Float32Array.of(0, 0, 0)));
    const off = Math.hypot(...[0, 1, 2].map((i) => (a?.[i] ?? 0) - (b?.[i] ?? 0)));
    // The diameter is about two units.
    assert.ok(off < 0.01 * 2 * expected.scale, `${off} m`);
  }
  // Placed, it is where the camera sees the object: its identity scores as the result does.
  const placed = placeSplats(ply, expected);
  const identity = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] } as const;
  const { metrics } = await aligner.evaluate({ ...input, mesh: placed }, identity);
  assert.ok((metrics.iou ?? 0) > 0.97, `iou ${metrics.iou}`);
});

test("files that other programs wrote are read with their colours", async () => {
  for (const name of ["splat.ply", "mesh.splat"]) {
    const { positions, indices, samples, warnings } = await readMesh(readFileSync(join(fixtures, name)));
    assert.ok(indices.length > 300 && warnings.length === 0, name);
    const extent = (axis: number) => {
      const along = positions.filter((_, i) => i % 3 === axis);
      return Math.max(...along) - Math.min(...along);
    };
    [2, 4, 6].forEach((expected, axis) => {
      assert.ok(Math.abs(extent(axis) - expected) < 0.3, `${name}: ${extent(axis)} along ${axis}`);
    });
    // Red grows with x, green with y and blue with z.
    assert.ok(samples !== undefined, name);
    const { positions: points, colors } = samples;
    const mean = (axis: number, sign: number) => {
      const middle = [0.25, -0.5, 10][axis] ?? 0;
      const on = colors.filter((_, i) => i % 3 === axis && sign * ((points[i] ?? 0) - middle) > 0.5);
      return on.reduce((sum, code) => sum + code, 0) / on.length;
    };
    for (const axis of [0, 1, 2]) assert.ok(mean(axis, 1) - mean(axis, -1) > 60, `${name}: ${axis}`);
    const plain = await readMesh(readFileSync(join(fixtures, name)), { colors: false });
    assert.deepEqual([plain.samples, plain.indices], [undefined, indices], name);
  }
});

test("damaged splats are refused, and meshes are no splats", async () => {
  await rejectsWith(() => readMesh(ply.slice(0, -1)), "CORRUPT_FILE mesh");
  await rejectsWith(() => readMesh(new Uint8Array(33), { format: "splat" }), "CORRUPT_FILE mesh");
  const transparent = gaussians.map((gaussian) => ({ ...gaussian, opacity: 0.01 }));
  await rejectsWith(() => readMesh(splatPly(transparent)), "EMPTY_MESH mesh");
  const aligner = await createAligner();
  const input = { depth, width, height, mask, camera, mesh: splatPly(transparent) };
  await rejectsWith(() => aligner.align(input), "EMPTY_MESH mesh");
  const { indices } = await readMesh(readFileSync(join(fixtures, "mesh-colors.ply")));
  assert.equal(indices.length, 36);
});

test("the module of splats is loaded when one is passed, from where it is said to be", () => {
  const script = `
    import assert from "node:assert/strict";
    import { readFileSync } from "node:fs";
    import { createAligner } from "sim3align";
    import { readMesh } from "sim3align/formats";
    const sizes = [];
    const { compile } = WebAssembly;
    // Node's own modules are small.
    WebAssembly.compile = (bytes) => (bytes.byteLength > 50_000 && sizes.push(bytes.byteLength), compile(bytes));
    const mesh = readFileSync(${JSON.stringify(join(fixtures, "splat.ply"))});
    const aligner = await createAligner({ wasm: { splats: "file:///nowhere.wasm" } });
    const input = { depth: new Float32Array(1), width: 1, height: 1, mask: new Uint8Array(1) };
    const camera = { fx: 1, fy: 1, cx: 0, cy: 0 };
    const failed = { code: "NOT_INITIALISED", argument: "wasm.splats" };
    await assert.rejects(aligner.align({ ...input, camera, mesh }), failed);
    const before = sizes.length;
    await readMesh(mesh);
    await readMesh(mesh);
    console.log(sizes.length - before);
  `;
  const output = execFileSync(process.execPath, ["--input-type=module", "--eval", script], { encoding: "utf8" });
  assert.equal(output, "1\n");
});
