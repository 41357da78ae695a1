/** Codes of depth, point maps and what else a depth file may hold: each is read, or named. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, type DepthCode } from "sim3align";
import { depthFromCode } from "sim3align/conventions";
import { readDepth } from "sim3align/formats";
import { codesOf } from "../support/errors.js";
import { npy, png } from "../support/files.js";
import { assertNear } from "../support/random.js";
import { input, truth, view } from "../support/scene.js";
import { deflated, zip } from "../support/zip.js";

const { width, height, depth, mask, camera } = view;
const size = { width, height };
const aligner = await createAligner();

const logarithm = (z: number, [near, far]: [number, number], levels: number) =>
  Math.round((levels * Math.log((z + 3.5) / (near + 3.5))) / Math.log((far + 3.5) / (near + 3.5)));
const in16 = (code: (z: number) => number) => png(Uint16Array.from(depth, code), width, height);
const in24 = (code: (z: number) => number, shifts: readonly number[]) =>
  png(
    Uint8Array.from(
      { length: 3 * depth.length },
      (_, i) => code(depth[Math.floor(i / 3)] as number) >> (shifts[i % 3] as number),
    ),
    width,
    height,
    3,
  );
const plane = { depthNear: 0.2, depthFar: 3 };
const zBuffer = (z: number) => (3 * (z - 0.2)) / (z * 2.8);

/** A file of each code, and the warning or the words of the error that it gets without one. */
const codes: [code: DepthCode, file: Uint8Array, settings: object, sign: string | RegExp | null][] = [
  ["sun-rgbd", in16((z) => Math.round(1000 * z) << 3), {}, "DEPTH_LOOKS_CODED"],
  ["half-float", in16(halfBits), {}, "DEPTH_LOOKS_CODED"],
  ["lerobot", in16((z) => logarithm(z, [0.01, 10], 4095)), {}, null],
  ["behavior", in16((z) => logarithm(z, [0, 10], 16383)), {}, null],
  ["rlbench", in24((z) => ((z - 0.2) / 2.8) * (2 ** 24 - 1), [16, 8, 0]), plane, /RLBench/],
  ["carla", in24((z) => (z / 1000) * (2 ** 24 - 1), [0, 8, 16]), {}, /CARLA/],
  ["z-buffer", npy(depth.map(zBuffer), height, width), plane, null],
];

/** The bits of a 16-bit float from 2^-14 on. */
function halfBits(z: number): number {
  const exponent = Math.floor(Math.log2(z));
  return ((exponent + 15) << 10) + Math.round((z / 2 ** exponent - 1) * 1024);
}

test("depth of every code is the same depth; numbers that are no lengths are named", async () => {
  for (const [depthCode, file, settings, sign] of codes) {
    const read = await readDepth(file, { depthCode, ...settings });
    assertNear(read.data, depth, depthCode, 0.002);
    assert.deepEqual(read.unit, { metres: 1, source: `depthCode ${depthCode}`, isAssumed: false });
    if (sign instanceof RegExp) {
      await assert.rejects(
        readDepth(file),
        ({ code, found }) => code === "EIGHT_BIT_DEPTH" && sign.test(found),
        depthCode,
      );
      continue;
    }
    const plain = await aligner.evaluate({ ...input, ...size, depth: file, mask, camera }, truth);
    assert.deepEqual(
      codesOf(plain.warnings).filter((code) => code === "DEPTH_LOOKS_CODED"),
      sign === null ? [] : [sign],
      depthCode,
    );
  }
  const codesOfMap = { data: Uint16Array.from(depth, (z) => Math.round(1000 * z) << 3), ...size };
  assertNear(depthFromCode(codesOfMap, "sun-rgbd").data, depth, "converted", 0.002);
  await assert.rejects(readDepth(codes[6]?.[1] as Uint8Array, { depthCode: "z-buffer" }), { argument: "depthNear" });
});

/** A plane seen from above, half a metre to 4 m away. */
const tilted = Float32Array.from(
  { length: width * height },
  (_, i) => 1 / (0.25 + 1.6 * (Math.floor(i / width) / height) + 0.1 * ((i % width) / width)),
);

test("planes tell logarithmic codes and z-buffers from depth", async () => {
  const square = Uint8Array.from(mask, (_, i) =>
    i % width > 60 && i % width < 90 && i > 40 * width && i < 80 * width ? 1 : 0,
  );
  const warned = async (depth: Float32Array | Uint16Array) =>
    codesOf((await aligner.evaluate({ ...input, depth, ...size, mask: square }, truth)).warnings).includes(
      "DEPTH_LOOKS_CODED",
    );
  for (const [name, map, expected] of [
    ["millimetres", Uint16Array.from(tilted, (z) => Math.round(1000 * z)), false],
    ["LeRobot", Uint16Array.from(tilted, (z) => logarithm(z, [0.01, 10], 4095)), true],
    ["BEHAVIOR", Uint16Array.from(tilted, (z) => logarithm(z, [0, 10], 16383)), true],
    ["within a metre", tilted.map((z) => z / 4.1), false],
    ["z-buffer", tilted.map((z) => (5 * (z - 0.2)) / (z * 4.8)), true],
  ] as const) {
    assert.equal(await warned(map), expected, name);
  }
});

test("depth of sensors that round, and of other units, is no code", async () => {
  for (const step of [1, 2, 5, 10, 16, 25]) {
    const rounded = Uint16Array.from(depth, (z) => step * Math.round((1000 * z) / step));
    for (const depthScale of [undefined, 0.001, 0.0002]) {
      const { warnings } = await aligner.evaluate({ ...input, depth: rounded, ...size, depthScale }, truth);
      assert.equal(codesOf(warnings).includes("DEPTH_LOOKS_CODED"), false, `steps of ${step}`);
    }
  }
});

/** The points of the view, x, y, z each, or all x, all y, all z. */
function pointsOf(signs: readonly number[], order: readonly number[], isInterleaved = true): Float32Array {
  return Float32Array.from({ length: 3 * depth.length }, (_, k) => {
    const [i, axis] = isInterleaved ? [Math.floor(k / 3), k % 3] : [k % depth.length, Math.floor(k / depth.length)];
    const z = depth[i] as number;
    const point = [
      ((i % width) - camera.cx) * (z / camera.fx),
      (Math.floor(i / width) - camera.cy) * (z / camera.fy),
      z,
    ];
    return (signs[axis] as number) * (point[order[axis] as number] as number);
  });
}
const shaped = (values: Float32Array, shape: string) => {
  const file = Buffer.from(npy(values, 100000, 100000));
  const text = file.toString("latin1", 0, 128);
  return Buffer.concat([Buffer.from(text.replace("(100000, 100000)", shape.padEnd(16)), "latin1"), file.subarray(128)]);
};
const [rows, planes] = [`(${height}, ${width}, 3)`, `(3, ${height}, ${width})`];
const pfm = (values: Float32Array) => {
  const bottomUp = Array.from({ length: height }, (_, v) =>
    values.subarray(3 * width * (height - 1 - v), 3 * width * (height - v)),
  );
  return Buffer.concat([
    Buffer.from(`PF\n${width} ${height}\n-1\n`),
    ...bottomUp.map((row) => new Uint8Array(row.slice().buffer)),
  ]);
};
const opencv = pointsOf([1, 1, 1], [0, 1, 2]);
const archive = (arrays: Record<string, Uint8Array>) =>
  zip(Object.entries(arrays).map(([name, bytes]) => deflated(`${name}.npy`, bytes)));
const maps: [what: string, file: Uint8Array, axes: string][] = [
  ["OpenCV", shaped(opencv, rows), ""],
  ["OpenCV, planes", shaped(pointsOf([1, 1, 1], [0, 1, 2], false), planes), ""],
  ["OpenGL", shaped(pointsOf([1, -1, -1], [0, 1, 2]), rows), "x right, y up, z backward"],
  ["PyTorch3D", shaped(pointsOf([-1, -1, 1], [0, 1, 2]), rows), "x left, y up, z forward"],
  ["ROS", shaped(pointsOf([1, -1, -1], [2, 0, 1]), rows), "x forward, y left, z up"],
  ["PFM", pfm(opencv), ""],
  ["NPZ", archive({ pts3d: shaped(opencv, rows) }), ""],
  ["NPZ beside depth", archive({ depth: npy(depth, height, width), xyz: shaped(opencv, rows) }), ""],
];

test("a point map in any frame is read as its depth, with the camera that sees it", async () => {
  for (const [what, file, axes] of maps) {
    const read = await readDepth(file);
    assertNear(read.data, depth, what, 1e-6);
    assert.equal(read.unit.source, axes === "" ? "float values" : `float values, a point map with ${axes}`, what);
    const { fx, fy, cx, cy } = read.camera ?? { fx: 0, fy: 0, cx: 0, cy: 0 };
    assertNear([fx, fy, cx, cy], [camera.fx, camera.fy, camera.cx, camera.cy], what, 0.01);
  }
  const colours = shaped(
    Float32Array.from(opencv, (_, i) => (i * 7919) % 256),
    rows,
  );
  await assert.rejects(readDepth(colours), { code: "UNSUPPORTED_FORMAT" });
});

const map = (shape: string) => shaped(depth, shape);
const degrees = (side: number, focal: number) =>
  shaped(Float32Array.of((360 / Math.PI) * Math.atan(side / 2 / focal)), "()");
const { fx, fy, cx, cy } = camera;

const middle = [(width - 1) / 2, (height - 1) / 2];

/** Archives, as the programs around depth models save them, and the numbers of their cameras. */
const archives: [what: string, camera: number[], arrays: Record<string, Uint8Array>][] = [
  [
    "Depth Pro",
    [fx, fx, ...middle],
    { depth: map(`(${height}, ${width})`), focallength_px: shaped(Float32Array.of(fx), "()") },
  ],
  [
    "UniDepth, a batch of one image",
    [fx, fy, cx, cy],
    {
      depth: map(`(1, 1, ${height}, ${width})`),
      intrinsics: shaped(Float32Array.of(fx, 0, cx, 0, fy, cy, 0, 0, 1), "(1, 3, 3)"),
    },
  ],
  [
    "MoGe, in image sizes",
    [fx, fy, cx, cy],
    {
      depth: map(`(${height}, ${width})`),
      intrinsics: npy(
        Float32Array.of(fx / width, 0, (cx + 0.5) / width, 0, fy / height, (cy + 0.5) / height, 0, 0, 1),
        3,
        3,
      ),
    },
  ],
  [
    "fields of view",
    [fx, fy, ...middle],
    { pred_depth: map(`(${height}, ${width})`), fov_x: degrees(width, fx), fov_y: degrees(height, fy) },
  ],
  [
    "DUSt3R, with arrays that are not known",
    [fx, fx, cx, cy],
    {
      depth: map(`(${height}, ${width})`),
      focals: shaped(Float32Array.of(fx), "(1,)"),
      principal_points: shaped(Float32Array.of(cx, cy), "(1, 2)"),
      confidence: map(`(${height}, ${width})`),
      odd: map(`(${height}, ${width})`),
    },
  ],
];

test("intrinsics, focal lengths and fields of view of an archive are its camera; arrays that are not known are named", async () => {
  for (const [what, camera, arrays] of archives) {
    const { data, camera: found, unread } = await readDepth(archive(arrays));
    assertNear(data, depth, what);
    assertNear(Object.values(found ?? {}), camera, what, 1e-4);
    assert.deepEqual(unread ?? [], "odd" in arrays ? ["the array `odd` of the depth file"] : [], what);
  }
});

/** A TIFF of 16-bit samples, with other tags. */
function tiff(tags: readonly (readonly [tag: number, value: number])[], isBig = false): Uint8Array {
  const pixels = Buffer.from(Uint16Array.from(depth, (z) => Math.round(1000 * z)).buffer);
  const start = isBig ? 16 : 8;
  const all = [
    ...[
      [256, width],
      [257, height],
      [258, 16],
      [259, 1],
      [262, 1],
      [273, start],
      [277, 1],
      [278, height],
      [279, pixels.length],
    ],
    ...tags,
  ] as [number, number][];
  const entries = [...new Map(all)]
    .sort(([a], [b]) => a - b)
    .map(([tag, value]) => {
      const entry = Buffer.alloc(isBig ? 20 : 12);
      entry.writeUInt16LE(tag, 0);
      entry.writeUInt16LE(4, 2);
      entry.writeUInt32LE(1, 4);
      entry.writeUInt32LE(value, isBig ? 12 : 8);
      return entry;
    });
  const head = Buffer.alloc(start);
  head.write(isBig ? "II+\0\x08\0" : "II*\0", "latin1");
  head.writeUInt32LE(start + pixels.length, isBig ? 8 : 4);
  const count = Buffer.alloc(isBig ? 8 : 2);
  count.writeUInt16LE(entries.length);
  return Buffer.concat([head, pixels, count, ...entries, Buffer.alloc(8)]);
}

test("TIFF: stored numbers whatever white is, BigTIFF, and tags that are not known", async () => {
  for (const [what, file] of [
    ["plain", tiff([])],
    ["white is zero", tiff([[262, 0]])],
    ["big", tiff([], true)],
  ] as const) {
    const read = await readDepth(file);
    assertNear(read.data, depth, what, 0.0006);
    assert.equal(read.unread, undefined, what);
  }
  const { unread } = await readDepth(
    tiff([
      [274, 3],
      [50000, 7],
    ]),
  );
  assert.deepEqual(unread, ["tag 274 of the TIFF", "tag 50000 of the TIFF"]);
});
