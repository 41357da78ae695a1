/** Placed splats show, from every side, what the original ones show. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { applyToPoints, exportPly, invert, placeSplats, toFrame, toSim3 } from "sim3align/conventions";
import { repository } from "../support/environment.js";
import { type Fault, rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { mesh, truth } from "../support/scene.js";
import { type Gaussian, gaussiansIn, gaussiansInRecords, splatPly, splatRecords } from "../support/splats.js";

const draw = (random: Random, degree: number): Gaussian => ({
  position: random.list(3, -2, 2),
  scales: random.list(3, 0.01, 0.3),
  rotation: random.list(4, -1, 1),
  opacity: random.between(0.05, 0.95),
  color: random.list(3, 0, 255).map(Math.round),
  harmonics: random.list(3 * ((degree + 1) ** 2 - 1), -0.5, 0.5),
});

/** Rows of the rotation of a quaternion w, x, y, z. */
function rows(quaternion: readonly number[]): number[][] {
  const [w = 0, x = 0, y = 0, z = 0] = quaternion.map((q) => q / Math.hypot(...quaternion));
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}

const times = (m: readonly number[][], v: readonly number[]) =>
  m.map((row) => row.reduce((sum, x, i) => sum + x * (v[i] ?? 0), 0));

/** The variance of a Gaussian along a direction. */
function variance({ rotation, scales }: Gaussian, direction: readonly number[]): number {
  const matrix = rows(rotation);
  return [0, 1, 2].reduce((sum, axis) => {
    const along = direction.reduce((total, d, i) => total + d * (matrix[i]?.[axis] ?? 0), 0);
    return sum + (along * (scales[axis] ?? 0)) ** 2;
  }, 0);
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

function direction(random: Random): number[] {
  const drawn = random.list(3, -1, 1);
  return drawn.map((x) => x / Math.hypot(...drawn));
}

for (const degree of [0, 1, 2, 3]) {
  test(`positions, shapes and colours towards all sides, harmonics of degree ${degree}`, () => {
    forSeeds(6, (random, seed) => {
      const before = Array.from({ length: 8 }, () => draw(random, degree));
      const pose = toSim3(random.pose());
      const file = splatPly(before);
      const original = file.slice();
      const after = gaussiansIn(placeSplats(file, pose));
      assert.deepEqual(file, original, `${seed}: the input is unchanged`);
      assert.equal(after.length, before.length, seed);
      const turn = pose.rotationMatrix as number[][];
      for (const [i, gaussian] of before.entries()) {
        const placed = after[i] as (typeof after)[number];
        const expected = applyToPoints(pose, Float64Array.from(gaussian.position));
        assertNear(placed.position, expected, `${seed}: position`, 1e-6);
        assertNear(placed.normal, times(turn, [0, 0, 1]), `${seed}: normal`, 1e-6);
        assert.deepEqual([placed.label, placed.harmonics.length], [i, gaussian.harmonics.length], seed);
        assertNear([placed.opacity, ...placed.color], [gaussian.opacity, ...gaussian.color], seed, 1e-5);
        for (let k = 0; k < 20; k++) {
          const from = direction(random);
          const to = times(turn, from);
          const ratio = variance(placed, to) / (pose.scale ** 2 * variance(gaussian, from));
          assert.ok(Math.abs(ratio - 1) < 1e-4, `${seed}: variance by ${ratio}`);
          assertNear(colors(placed, to), colors(gaussian, from), `${seed}: colours`, 1e-6);
        }
      }
    });
  });
}

test(".splat files: positions, and shapes up to the bytes of their rotations", () => {
  forSeeds(6, (random, seed) => {
    const before = gaussiansInRecords(splatRecords(Array.from({ length: 8 }, () => draw(random, 0))));
    const pose = toSim3(random.pose());
    const after = gaussiansInRecords(placeSplats(splatRecords(before), pose));
    for (const [i, gaussian] of before.entries()) {
      const placed = after[i] as Gaussian;
      assertNear(placed.position, applyToPoints(pose, Float64Array.from(gaussian.position)), seed, 1e-6);
      assertNear(
        placed.scales,
        gaussian.scales.map((scale) => scale * pose.scale),
        seed,
        1e-6,
      );
      assert.deepEqual([placed.color, placed.opacity], [gaussian.color, gaussian.opacity], seed);
      const axes = [0, 1, 2].map((axis) => rows(placed.rotation).map((row) => row[axis] ?? 0));
      const expected = [0, 1, 2].map((axis) =>
        times(
          pose.rotationMatrix as number[][],
          rows(gaussian.rotation).map((row) => row[axis] ?? 0),
        ),
      );
      assertNear(axes.flat(), expected.flat(), seed, 0.03);
    }
  });
});

test("frames, buffers, and the way back", () => {
  const file = readFileSync(join(repository, "tests", "fixtures", "splat.ply"));
  assert.deepEqual(placeSplats(file, truth, { frame: "opengl" }), placeSplats(file, toFrame(truth, "opengl")));
  assert.deepEqual(placeSplats(Uint8Array.from(file).buffer, truth), placeSplats(file, truth));
  const back = placeSplats(placeSplats(file, truth), invert(truth));
  const floats = (bytes: Uint8Array) => {
    const start = Buffer.from(bytes).indexOf("end_header\n") + 11;
    return new Float32Array(Uint8Array.from(bytes.subarray(start)).buffer);
  };
  assertNear(floats(back), floats(file), "back", 1e-6);
});

test("what is no file of Gaussians is refused", async () => {
  const good = readFileSync(join(repository, "tests", "fixtures", "splat.ply"));
  const renamed = (from: string, to: string) => Buffer.from(good.toString("latin1").replaceAll(from, to), "latin1");
  const cases: [unknown, Fault, RegExp][] = [
    ["splat.ply", "INVALID_ARGUMENT splats", /PLY or \.splat/],
    [new Uint8Array(), "UNSUPPORTED_FORMAT splats", /0 bytes/],
    [new Uint8Array(64), "UNSUPPORTED_FORMAT splats", /64 bytes/],
    [good.subarray(0, 100), "CORRUPT_FILE splats", /end_header/],
    [good.subarray(0, good.length - 1), "CORRUPT_FILE splats", /as many as/],
    [exportPly(mesh), "UNSUPPORTED_FORMAT splats", /without Gaussians/],
    [renamed("binary_little_endian", "ascii"), "UNSUPPORTED_FORMAT splats", /format ascii/],
    [renamed("f_rest_8", "another"), "UNSUPPORTED_FORMAT splats", /8 properties f_rest/],
    [renamed("property float opacity", "property list uchar int opacity"), "CORRUPT_FILE splats", /"list"/],
  ];
  for (const [wrong, ...expected] of cases) await rejectsWith(() => placeSplats(wrong as never, truth), ...expected);
  await rejectsWith(() => placeSplats(good, truth, { frame: "blender" as never }), "INVALID_OPTION options.frame");
  await rejectsWith(() => placeSplats(good, { ...truth, scale: 0 }), "INVALID_TRANSFORM transform.scale");
});
