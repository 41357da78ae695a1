/** Files that real programs wrote, their versions in the index: readers give back the one object that all of them show. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fromRle } from "sim3align/conventions";
import { readCamera, readDepth, readMask, readMesh } from "sim3align/formats";
import { repository } from "../support/environment.js";

interface Row {
  program: string;
  version: string;
  kind: string;
  variant: string;
  file: string;
  expect: { axes?: number[][]; warns?: string; refused?: string; says?: string; limit?: number; camera?: object };
}

const folder = join(repository, "tests", "fixtures", "interop");
const index: (Row & { expect: { rle?: "cvat"; options?: object; colors?: string } })[] = JSON.parse(
  readFileSync(join(folder, "index.json"), "utf8"),
);
const bytesOf = (row: Row | undefined) => readFileSync(join(folder, row?.file ?? ""));
const rows = (kind: string) => index.filter((row) => row.kind === kind && row.expect.refused === undefined);
const size = { width: 160, height: 120 };

/** The body: its box, its volume, and the print of a place on it. */
const lower = [-0.02, 0.01, 0.03];
const upper = [0.15, 0.1, 0.08];
const VOLUME = 0.000597666;
const print = ([x = 0, y = 0]: readonly number[]) => [40 + 1000 * (x + 0.02), 40 + (170 / 0.09) * (y - 0.01), 160];

for (const { program, version, variant, ...row } of rows("mesh")) {
  test(`${program} ${version}, ${variant}: axes, size, place, winding and print`, async () => {
    const mesh = await readMesh(bytesOf(row as Row), row.expect.options);
    const toBody = (p: number[]) =>
      row.expect.axes?.map((from) => from.reduce((sum, each, k) => sum + each * (p[k] ?? 0), 0)) ?? p;
    const point = (from: ArrayLike<number>, i: number) => toBody([0, 1, 2].map((k) => from[3 * i + k] ?? 0));
    const points = Array.from({ length: mesh.positions.length / 3 }, (_, i) => point(mesh.positions, i));
    const limit = row.expect.limit ?? 1e-6;
    for (const k of [0, 1, 2]) {
      const along = points.map((p) => p[k] ?? 0);
      assert.ok(Math.abs(Math.min(...along) - (lower[k] ?? 0)) <= limit, `lower ${k}: ${Math.min(...along)}`);
      assert.ok(Math.abs(Math.max(...along) - (upper[k] ?? 0)) <= limit, `upper ${k}: ${Math.max(...along)}`);
    }
    let volume = 0;
    for (let i = 0; i < mesh.indices.length; i += 3) {
      const [a = [], b = [], c = []] = [0, 1, 2].map((k) => points[mesh.indices[i + k] ?? 0]);
      const [x = 0, y = 0, z = 0] = a;
      const [p = 0, q = 0, r = 0] = b;
      const [s = 0, t = 0, u = 0] = c;
      volume += (x * (q * u - r * t) + y * (r * s - p * u) + z * (p * t - q * s)) / 6;
    }
    assert.ok(Math.abs(volume / VOLUME - 1) < 0.003, `volume ${volume}`);
    if (row.expect.colors === undefined) return;
    const { positions, colors } = mesh.samples ?? { positions: [], colors: [] };
    let off = 0;
    for (let i = 0; i < positions.length / 3; i++) {
      for (const [k, level] of print(point(positions, i)).entries()) off += Math.abs((colors[3 * i + k] ?? 0) - level);
    }
    assert.ok(positions.length > 0 && off / positions.length < 10, `${off / positions.length} levels`);
  });
}

test("depth of every program is the same depth, to half a millimetre", async () => {
  const [first, ...others] = await Promise.all(rows("depth").map((row) => readDepth(bytesOf(row))));
  assert.ok(first !== undefined && others.length > 2 && first.width === size.width);
  const near = [...first.data].filter((z) => z > 0 && z < 0.6).length;
  assert.ok(near > 2000, `${near} pixels of the body`);
  for (const other of others) {
    const most = other.data.reduce((worst, z, i) => Math.max(worst, Math.abs(z - (first.data[i] ?? 0))), 0);
    assert.ok(most <= 0.00051, `${most} m`);
  }
});

test("masks of every program are the same mask", async () => {
  const masks = rows("mask").map(async (row) => {
    const { rle } = row.expect;
    const { data } = await (rle === undefined
      ? readMask(bytesOf(row))
      : fromRle(JSON.parse(bytesOf(row).toString()), rle, size));
    return [row.program, Buffer.from(data).toString("base64")];
  });
  const [[, first] = [], ...others] = await Promise.all(masks);
  for (const [program, mask] of others) assert.equal(mask, first, program);
});

test("cameras of every program are the same camera, and name their distortion", async () => {
  for (const row of rows("camera")) {
    const { fx, fy, cx, cy, warnings } = await readCamera(bytesOf(row), size);
    const [title, known] = [`${row.program}, ${row.variant}`, { fx: 150, fy: 152, cx: 78.5, cy: 60.25 }];
    for (const [key, value] of Object.entries(known)) {
      assert.ok(Math.abs({ fx, fy, cx, cy }[key as "fx"] - value) < 1e-3, `${title}: ${key}`);
    }
    assert.match(warnings.join(), new RegExp(row.expect.warns ?? "^$"), title);
  }
});

test("what is not read is named", async () => {
  for (const row of index.filter(({ expect }) => expect.refused !== undefined)) {
    const { refused: code, says = "" } = row.expect;
    const isNamed = (error: { code: string; message: string }) => error.code === code && error.message.includes(says);
    await assert.rejects(readDepth(bytesOf(row)), isNamed, row.variant);
  }
});
