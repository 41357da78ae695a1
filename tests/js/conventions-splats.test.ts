/** 3D Gaussians: placed, they show from every side what the original ones show; as meshes, they are aligned. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { applyToPoints, exportPly, placeSplats, toFrame, toSim3 } from "sim3align/conventions";
import { type Refused, rejectsWith } from "../support/errors.js";
import { fixture } from "../support/files.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { turnBetween } from "../support/rig.js";
import { input, mesh, rotationRows, truth } from "../support/scene.js";
import { type Gaussian, gaussiansIn, gaussiansInRecords, splatOf, splatPly, splatRecords } from "../support/splats.js";

const draw = (random: Random, degree: number): Gaussian => ({
  ...{ position: random.list(3, -2, 2), scales: random.list(3, 0.01, 0.3), rotation: random.list(4, -1, 1) },
  ...{ opacity: random.between(0.05, 0.95), color: random.list(3, 0, 255).map(Math.round) },
  harmonics: random.list(3 * ((degree + 1) ** 2 - 1), -0.5, 0.5),
});

/** Rows of the rotation of a quaternion w, x, y, z. */
function rows(quaternion: readonly number[]): number[][] {
  const [w = 0, x = 0, y = 0, z = 0] = quaternion.map((q) => q / Math.hypot(...quaternion));
  return rotationRows([x, y, z, w]);
}

const times = (m: readonly (readonly number[])[], v: readonly number[]) =>
  m.map((row) => row.reduce((sum, x, i) => sum + x * (v[i] ?? 0), 0));

/** The variance of a Gaussian along a direction. */
function variance({ rotation, scales }: Gaussian, direction: readonly number[]): number {
  const columns = [0, 1, 2].map((axis) => rows(rotation).map((row) => row[axis] ?? 0));
  return times(columns, direction).reduce((sum, along, axis) => sum + (along * (scales[axis] ?? 0)) ** 2, 0);
}

/** The associated Legendre function with the phase of Condon and Shortley, by its recurrences. */
function legendre(l: number, m: number, x: number): number {
  if (l === m) return (-1) ** m * odd(2 * m - 1) * (1 - x * x) ** (m / 2);
  const next = (2 * l - 1) * x * legendre(l - 1, m, x);
  return l === m + 1 ? next : (next - (l + m - 1) * legendre(l - 2, m, x)) / (l - m);
}
const odd = (n: number): number => (n <= 1 ? 1 : n * odd(n - 2));
const factorial = (n: number): number => (n <= 1 ? 1 : n * factorial(n - 1));

/** Colours towards a unit vector: real harmonics by their definition, m from −l to l. */
function colors({ harmonics }: Gaussian, [x = 0, y = 0, z = 0]: readonly number[]): number[] {
  const perChannel = harmonics.length / 3;
  return [0, 1, 2].map((channel) => {
    let [sum, i] = [0, channel * perChannel];
    for (let l = 1; (l + 1) ** 2 - 1 <= perChannel; l++) {
      for (let m = -l; m <= l; m++) {
        const n = Math.abs(m);
        const norm = Math.sqrt(((2 * l + 1) / (4 * Math.PI)) * (factorial(l - n) / factorial(l + n)));
        const [azimuth, root] = [n * Math.atan2(y, x), m === 0 ? 1 : Math.SQRT2];
        const around = m < 0 ? Math.sin(azimuth) : Math.cos(azimuth);
        sum += (harmonics[i++] ?? 0) * root * norm * legendre(l, n, z) * around;
      }
    }
    return sum;
  });
}

test("positions, shapes and colours towards all sides, for harmonics of every degree", () => {
  for (const degree of [0, 1, 2, 3]) {
    forSeeds(4, (random, seed) => {
      const before = Array.from({ length: 8 }, () => draw(random, degree));
      const pose = toSim3(random.pose());
      const file = splatPly(before);
      const original = file.slice();
      const after = gaussiansIn(placeSplats(file, pose));
      assert.deepEqual([file, after.length], [original, before.length], `${seed}: the input is unchanged`);
      for (const [i, gaussian] of before.entries()) {
        const placed = after[i] as (typeof after)[number];
        assertNear(placed.position, applyToPoints(pose, Float64Array.from(gaussian.position)), seed, 1e-6);
        assertNear(placed.normal, times(pose.rotationMatrix, [0, 0, 1]), `${seed}: normal`, 1e-6);
        assert.deepEqual([placed.label, placed.harmonics.length], [i, gaussian.harmonics.length], seed);
        assertNear([placed.opacity, ...placed.color], [gaussian.opacity, ...gaussian.color], seed, 1e-5);
        for (let k = 0; k < 12; k++) {
          const drawn = random.list(3, -1, 1);
          const from = drawn.map((x) => x / Math.hypot(...drawn));
          const to = times(pose.rotationMatrix, from);
          const ratio = variance(placed, to) / (pose.scale ** 2 * variance(gaussian, from));
          assert.ok(Math.abs(ratio - 1) < 1e-4, `${seed}: variance by ${ratio}`);
          assertNear(colors(placed, to), colors(gaussian, from), `${seed}: colours`, 1e-6);
        }
      }
    });
  }
});

test(".splat files: positions, and shapes up to the bytes of their rotations", () => {
  forSeeds(6, (random, seed) => {
    const before = gaussiansInRecords(splatRecords(Array.from({ length: 8 }, () => draw(random, 0))));
    const pose = toSim3(random.pose());
    const after = gaussiansInRecords(placeSplats(splatRecords(before), pose));
    for (const [i, gaussian] of before.entries()) {
      const placed = after[i] as Gaussian;
      assertNear(placed.position, applyToPoints(pose, Float64Array.from(gaussian.position)), seed, 1e-6);
      const scaled = gaussian.scales.map((scale) => scale * pose.scale);
      assertNear(placed.scales, scaled, seed, 1e-6);
      assert.deepEqual([placed.color, placed.opacity], [gaussian.color, gaussian.opacity], seed);
      const columns = (of: Gaussian) => [0, 1, 2].map((axis) => rows(of.rotation).map((row) => row[axis] ?? 0));
      const expected = columns(gaussian).flatMap((column) => times(pose.rotationMatrix, column));
      assertNear(columns(placed).flat(), expected, seed, 0.03);
    }
  });
  const file = fixture("splat.ply");
  assert.deepEqual(placeSplats(file, truth, { frame: "opengl" }), placeSplats(file, toFrame(truth, "opengl")));
  assert.deepEqual(placeSplats(file.buffer, truth), placeSplats(file, truth));
});

test("a splat is aligned where the mesh of the same object is, with and without workers", async () => {
  const aligner = await createAligner();
  using pool = await createAligner({ workers: 1 });
  const expected = await aligner.align(input, { quality: "fast" });
  const gaussians = splatOf(mesh);
  const [ply, records] = [splatPly(gaussians), splatRecords(gaussians)];
  const forms = [
    [aligner, ply],
    [pool, { bytes: records, format: "splat" }],
  ] as const;
  for (const [one, mesh] of forms) {
    const found = await one.align({ ...input, mesh }, { quality: "fast" });
    assert.ok(Math.abs(found.scale / expected.scale - 1) < 0.01, `scale ${found.scale} of ${expected.scale}`);
    assert.ok(turnBetween(found.rotation, expected.rotation) < 2, `${found.rotation} of ${expected.rotation}`);
    const off = Math.hypot(...found.translation.map((x, i) => x - (expected.translation[i] ?? 0)));
    // The diameter is about two units.
    assert.ok(off < 0.01 * 2 * expected.scale, `${off} m`);
  }
  // Placed, it is where the camera sees the object: its identity scores as the result does.
  const identity = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
  const { metrics } = await aligner.evaluate({ ...input, mesh: placeSplats(ply, expected) }, identity);
  assert.ok((metrics.iou ?? 0) > 0.97, `iou ${metrics.iou}`);
  const transparent = splatPly(gaussians.map((gaussian) => ({ ...gaussian, opacity: 0.01 })));
  await rejectsWith(() => aligner.align({ ...input, mesh: transparent }), "EMPTY_MESH mesh");
});

test("what is no file of Gaussians is refused", async () => {
  const good = Buffer.from(fixture("splat.ply"));
  const renamed = (from: string, to: string) => Buffer.from(good.toString("latin1").replaceAll(from, to), "latin1");
  const place =
    (file: unknown, pose = truth, options = {}) =>
    () =>
      placeSplats(file as never, pose, options);
  const refused: Refused[] = [
    [place("splat.ply"), "INVALID_ARGUMENT splats", /PLY or \.splat/],
    [place(new Uint8Array()), "UNSUPPORTED_FORMAT splats", /0 bytes/],
    [place(good.subarray(0, good.length - 1)), "CORRUPT_FILE splats", /as many as/],
    [place(exportPly(mesh)), "UNSUPPORTED_FORMAT splats", /without Gaussians/],
    [place(renamed("binary_little_endian", "ascii")), "UNSUPPORTED_FORMAT splats", /format ascii/],
    [place(renamed("f_rest_8", "another")), "UNSUPPORTED_FORMAT splats", /8 properties f_rest/],
    [place(good, truth, { frame: "blender" }), "INVALID_OPTION options.frame"],
  ];
  for (const each of refused) await rejectsWith(...each);
});
