/** Camera files of other programs: the same camera in each form, and what is named or refused. */
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { type ReadCameraOptions, readCamera } from "sim3align/formats";
import { repository } from "../support/environment.js";
import { type Fault, rejectsWith } from "../support/errors.js";
import { npy } from "../support/files.js";

const K = [600, 0, 319.5, 0, 610, 239.5, 0, 0, 1];
const rows = [K.slice(0, 3), K.slice(3, 6), K.slice(6)];
const intrinsics = { fx: 600, fy: 610, cx: 319.5, cy: 239.5 };
const fromEdge = { fl_x: 600, fl_y: 610, cx: 320, cy: 240, w: 640, h: 480 };
const size = { width: 640, height: 480 };
const none = [0, 0, 0, 0, 0];
const other = { fx: 300, fy: 300, cx: 400, cy: 300, width: 800, height: 600 };
const realSense = { fx: 600, fy: 610, ppx: 319.5, ppy: 239.5, coeffs: none };
const withNumber = (numbers: number[], place: number, number: number) =>
  numbers.map((other, i) => (i === place ? number : other));

/** Files of one camera, as tools and data sets write it, and the metres per unit of depth that some state. */
const folder = join(repository, "tests", "fixtures", "cameras");
const depthScales: Record<string, number> = JSON.parse(readFileSync(join(folder, "depth-scales.json"), "utf8"));
const cameras = readdirSync(folder)
  .filter((name) => name !== "depth-scales.json")
  .map((name) => ({ name, text: readFileSync(join(folder, name), "utf8"), depthScale: depthScales[name] }));
const objects = cameras.filter(({ name }) => name.endsWith(".json"));
const texts = cameras.filter(({ name }) => !name.endsWith(".json"));

async function readsAs(file: unknown, name: string, depthScale?: number) {
  const found = await readCamera(file as string, size);
  const { width: _, height: __, ...camera } = found;
  assert.deepEqual(camera, { ...intrinsics, ...(depthScale === undefined ? {} : { depthScale }), warnings: [] }, name);
}

test("cameras as text are the same camera, without a doubt", async () => {
  for (const { name, text, depthScale } of texts) {
    for (const file of [text, Buffer.from(text)]) await readsAs(file, name, depthScale);
  }
});

test("cameras of every tool are the same camera, as bytes, text, Blob and object, without a doubt", async () => {
  for (const { name, text, depthScale } of objects) {
    const marked = `\ufeff${text}`;
    const forms = [text, marked, Buffer.from(text), Buffer.from(marked), new Blob([text]), JSON.parse(text)];
    for (const file of forms) await readsAs(file, name, depthScale);
  }
});

test("K as NPY, in floats and in integers", async () => {
  await readsAs(npy(Float32Array.from(K), 3, 3), "floats");
  const { cx } = await readCamera(npy(Uint16Array.from([600, 0, 320, 0, 610, 240, 0, 0, 1]), 3, 3));
  assert.equal(cx, 320);
  await rejectsWith(
    () => readCamera(npy(Float32Array.from(K), 3, 3).subarray(0, 90)),
    "UNSUPPORTED_FORMAT camera",
    /NPY/,
  );
});

test("a key with numbers that is not known is named in every form, one that does not matter is not", async () => {
  const nested = (json: unknown, key: string) =>
    Array.isArray(json) ? { K: json, [key]: [1, 2] } : { ...(json as Record<string, unknown>), [key]: [1, 2] };
  for (const { name, text } of objects) {
    const json = JSON.parse(text);
    const { unread } = await readCamera(nested(json, "zoom_of_lens"), size);
    assert.match(unread?.[0] ?? "", /^camera: zoom_of_lens: numbers whose meaning is not known\.$/, name);
    assert.equal((await readCamera(nested(json, "timestamp_ns"), size)).unread, undefined, name);
  }
  const { unread } = await readCamera({ ...intrinsics, gravity: [0, -1, 0], rotation: 90, a: { b: 3 } });
  assert.match(unread?.[0] ?? "", /rotation, a\.b: .*gravity: .*cameraUp/);
});

test("a camera's size, depth scale and field of view are those of the file", async () => {
  const full = { ...intrinsics, ...size, depthScale: 0.001 };
  assert.deepEqual(await readCamera(full), { ...full, warnings: [] });
  const { fx, fy, cx, doubts } = await readCamera({ fov_y_deg: 60 }, size);
  assert.deepEqual([fx, cx, doubts], [fy, 319.5, undefined]);
  for (const angle of [{ fovy: 60 }, { yfov: Math.PI / 3 }, { vertical_fov: 60 }]) {
    const found = await readCamera(angle, size);
    assert.ok(Math.abs(found.fx - fx) < 1e-9 && /no principal point/.test(found.doubts?.[0] ?? ""));
  }
  assert.equal((await readCamera({ ...intrinsics, focalUncertainty: 0.1 })).focalUncertainty, 0.1);
  const isaac = {
    cameraAperture: [20, 15],
    cameraFocalLength: 18.75,
    cameraModel: "pinhole",
    renderProductResolution: [640, 480],
  };
  assert.deepEqual((await readCamera({ ...isaac, cameraFisheyeMaxFOV: 200 })).fx, 600);
});

test("pixels of renderers and of intrinsics in one side are square", async () => {
  const sensor = { lens: 45, sensor_width: 36, sensor_height: 24 };
  const normal = { fx: 0.9375, fy: 0.953125, cx: 0.5, cy: 0.375 };
  const cases: [Record<string, unknown>, [fx: number, fy: number], RegExp | undefined][] = [
    [sensor, [800, 800], /36 × 24 .* squares, and its width counted/],
    [{ ...sensor, sensor_fit: "AUTO" }, [800, 800], undefined],
    [{ ...sensor, sensor_fit: "VERTICAL" }, [900, 900], undefined],
    [{ ...sensor, sensor_height: 27 }, [800, 800], undefined],
    [
      { ...sensor, projection_matrix: [1.875, 0, 0, 0, 0, 2.5, 0, 0, 0, 0, -1, -1, 0, 0, -1, 0] },
      [600, 600],
      undefined,
    ],
    [normal, [600, 610], /about equal: both were read as parts of 640 pixels/],
    [{ ...normal, cy: 0.5 }, [600, 457.5], /would not be square/],
  ];
  for (const [file, focal, message] of cases) {
    const { fx, fy, doubts = [] } = await readCamera(file, size);
    assert.deepEqual([fx, fy], focal, JSON.stringify(file));
    const about = doubts.filter((doubt) => /square/.test(doubt) || /about equal/.test(doubt));
    assert.equal(about.length, message === undefined ? 0 : 1);
    assert.match(about[0] ?? "", message ?? /^$/);
  }
});

test("a unit that may be another one is doubted", async () => {
  const cases: [Record<string, unknown>, number, RegExp][] = [
    [{ ...realSense, depth_scale: 1 }, 0.001, /depth_scale 1 .* ppx/],
    [{ ...intrinsics, factor_depth: 0.001 }, 0.001, /factor_depth 0\.001 is 1000 m .* 0\.001 m/],
    [{ ...intrinsics, depthScale: 0.001, DepthMapFactor: 5000 }, 0.001, /depthScale .* DepthMapFactor/],
    [{ ...intrinsics, depth_unit_multiplier: 5 }, 0.005, /depth_unit_multiplier 5/],
  ];
  for (const [file, depthScale, message] of cases) {
    const found = await readCamera(file, size);
    assert.equal(found.depthScale, depthScale);
    assert.match(found.doubts?.[0] ?? "", message);
  }
});

test("lens distortion is named under each of its names, with its size", async () => {
  const list = [-0.28, 0.07, 0, 0, 0];
  const lists = [
    "D",
    "d",
    "coeffs",
    "disto",
    "distortion",
    "distCoeffs",
    "dist_coeffs",
    "dist",
    "distortion_coefficients",
  ];
  const forms = [
    ...lists.flatMap((key) => [
      { ...intrinsics, [key]: list },
      { ...intrinsics, [key]: [list] },
      { K, [key]: { rows: 1, data: list } },
    ]),
    ...[
      { ...fromEdge, k1: -0.28, k2: 0.07 },
      { ...intrinsics, distortion: { k1: -0.28, k2: 0.07 } },
    ],
    ...[
      `1 OPENCV 640 480 600 610 320 240 ${list.slice(0, 4).join(" ")}`,
      `fx: 600\nfy: 610\ncx: 319.5\ncy: 239.5\nk1: -0.28`,
    ],
    ...[{ ...intrinsics, FocalLength: [600, 610], RadialDistortion: [-0.28, 0.07], TangentialDistortion: [0, 0] }],
  ];
  for (const form of forms) {
    const { warnings } = await readCamera(form, size);
    assert.match(warnings[0] ?? "", /lens distortion \([\w, ]+\).* about \d\d pixels/, JSON.stringify(form));
  }
  const fisheye = [
    ...[
      { ...fromEdge, camera_model: "OPENCV_FISHEYE" },
      { ...fromEdge, is_fisheye: true },
      { K, D: none, distortion_model: "equidistant" },
    ],
    ...["1 OPENCV_FISHEYE 640 480 600 610 320 240 0 0 0 0", { ...intrinsics, lens_projection: "fisheye" }],
  ];
  for (const form of fisheye) assert.match((await readCamera(form, size)).warnings[0] ?? "", /fisheye.* \d\d pixels/);
  assert.deepEqual((await readCamera({ ...intrinsics, D: [1e-4, 0, 0, 0, 0] }, size)).warnings, []);
  assert.match((await readCamera({ K: withNumber(K, 1, 4) })).warnings[0] ?? "", /skew.* 1\.6/);
});

test("intrinsics of an image that is turned are turned and doubted, those of a depth model's image scaled", async () => {
  const upright = { width: 480, height: 640 };
  for (const form of [intrinsics, { ...intrinsics, ...size }, { K }]) {
    const { doubts, ...found } = await readCamera(form, upright);
    assert.deepEqual([found.fx, found.fy, found.cx, found.cy], [610, 600, 239.5, 319.5]);
    assert.match(doubts?.[0] ?? "", /turned by 90°/);
  }
  const model = await readCamera({ ...intrinsics, ...size }, { width: 686, height: 518 });
  assert.deepEqual([model.fx, model.fy], [(600 * 686) / 640, (610 * 518) / 480]);
});

test("of several images or cameras one has to be chosen", async () => {
  const entry = (f: number) => ({ cam_K: [f, 0, 1, 0, f, 1, 0, 0, 1], depth_scale: 1 });
  const file = { "3": entry(3), "20": entry(20), "100": entry(100) };
  for (const [imageId, fx] of [
    ["3", 3],
    [20, 20],
    ["000100", 100],
  ] as const) {
    assert.equal((await readCamera(file, { imageId })).fx, fx);
  }
  for (const imageId of [undefined, "4", ""]) {
    const fault = "INVALID_ARGUMENT options.imageId";
    await rejectsWith(() => readCamera(file, { imageId }), fault, /expected one of 3, 20, 100\./);
  }
  assert.equal((await readCamera({ "0": entry(5), "1": entry(6) }, { imageId: "000000" })).fx, 5);
  const named = {
    frames: [
      { file_path: "images/0001.png", ...other },
      { file_path: "images/0002.png", ...intrinsics },
    ],
  };
  assert.equal((await readCamera(named, { imageId: "0002" })).fx, 600);
  const single: [Parameters<typeof readCamera>[0], string | number, RegExp][] = [
    [{ "3": entry(3) }, 4, /found "4", expected one of 3\./],
    [{ left: intrinsics }, "right", /found "right", expected one of left\./],
    [{ frames: [named.frames[0]] }, "0002", /found "0002", expected one of images\/0001\.png\./],
    [entry(3), 3, /found "3", expected nothing: the file holds one camera, without an id\. Omit it\./],
  ];
  for (const [one, imageId, message] of single) {
    await rejectsWith(() => readCamera(one, { imageId }), "INVALID_ARGUMENT options.imageId", message);
  }
  assert.equal((await readCamera({ left: intrinsics }, { imageId: "left" })).fx, 600);
  const pair = { depth_camera: intrinsics, color_camera: other };
  const { fx, doubts } = await readCamera(pair);
  assert.deepEqual([fx, /2 cameras/.test(doubts?.[0] ?? "")], [600, true]);
});

const corrupt = [Buffer.of(0x7b, 0xff, 0x7d), "[".repeat(100_000), `{"fx": 600, "fy": `];
const unknown = ["", "nonsense", "# fx 600\nThe focal length is 600 px", Buffer.of(0, 1, 2, 3, 255)];
const others: unknown[] = [
  ...["1", "[]", "[1,2,3]", "{}", { fx: 600, fy: 610, cx: 319.5 }, { ...intrinsics, fx: "600" }],
  ...[{ K: [1, 2, 3] }, { K: [...rows, rows[0]] }, { K: "eye" }, { K: null }, { intrinsic_matrix: 7 }],
  ...[{ "0": { cam_R_m2c: [] } }, { ...intrinsics, fx: Number.NaN }],
];
const refused: [unknown, Fault, RegExp, ReadCameraOptions?][] = [
  ...corrupt.map((file): [unknown, Fault, RegExp] => [file, "CORRUPT_FILE camera", /JSON.* download or export/]),
  ...unknown.map((file): [unknown, Fault, RegExp] => [file, "UNSUPPORTED_FORMAT camera", /YAML.*fx fy cx cy/]),
  ...others.map((file): [unknown, Fault, RegExp] => [file, "INVALID_CAMERA camera", /fx, fy, cx and cy/]),
  [
    { focal_of: 1, center: 2 },
    "INVALID_CAMERA camera",
    /found an object with focal_of, center.* Write .* fx, fy, cx and cy/,
  ],
  [{ ...intrinsics, fx: 0 }, "INVALID_CAMERA camera.fx", /found 0/],
  ...[0, -1, "1", null].map((depth_scale): [unknown, Fault, RegExp] => [
    ...([{ ...intrinsics, depth_scale }, "INVALID_CAMERA camera.depthScale", /number above 0/] as const),
  ]),
  [{ K: withNumber(K, 8, 0) }, "INVALID_CAMERA camera.K", /row-major/],
  [`{${" ".repeat(1 << 24)}}`, "FILE_TOO_LARGE camera", /16777216/],
  [{ fovYDeg: 180 }, "INVALID_CAMERA camera.fovYDeg", /below 180/, size],
  [{ fovYDeg: 60 }, "INVALID_ARGUMENT options.width", /field of view/],
  [{ fov: 60 }, "INVALID_CAMERA camera", /direction.*CARLA/, size],
  [{ focal_length: 35 }, "INVALID_CAMERA camera", /millimetres/, size],
  [{ camera_model: "omni", intrinsics: [1, ...[600, 610, 319.5, 239.5]] }, "UNSUPPORTED_FORMAT camera", /omni/],
  [{ a: intrinsics, b: { ...intrinsics, fx: 9 } }, "INVALID_ARGUMENT options.imageId", /one of a, b/],
  [{ ...intrinsics, ...size }, "SIZE_MISMATCH camera", /640 × 480.*320 × 200/, { width: 320, height: 200 }],
];

test("what is no camera is refused, with its true cause", async () => {
  for (const [file, fault, message, options] of refused) {
    await rejectsWith(() => readCamera(file as string, options), fault, message);
  }
});
