/** Camera files of other programs: the same camera in each form, and what is named or refused. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type ReadCameraOptions, readCamera } from "sim3align/formats";
import { type Fault, rejectsWith } from "../support/errors.js";
import { npy } from "../support/files.js";

const K = [600, 0, 319.5, 0, 610, 239.5, 0, 0, 1];
const rows = [K.slice(0, 3), K.slice(3, 6), K.slice(6)];
const columns = [600, 0, 0, 0, 610, 0, 319.5, 239.5, 1];
const intrinsics = { fx: 600, fy: 610, cx: 319.5, cy: 239.5 };
const fromEdge = { fl_x: 600, fl_y: 610, cx: 320, cy: 240, w: 640, h: 480 };
const size = { width: 640, height: 480 };
const none = [0, 0, 0, 0, 0];
const still = [
  [1, 0, 0, 0],
  [0, 1, 0, 0],
];
const other = { fx: 300, fy: 300, cx: 400, cy: 300, width: 800, height: 600 };
const realSense = { fx: 600, fy: 610, ppx: 319.5, ppy: 239.5, coeffs: none };
const sensor = { K: [600, 0, 639.5, 0, 610, 359.5, 0, 0, 1], width: 1280, height: 720 };
const withNumber = (numbers: number[], place: number, number: number) =>
  numbers.map((other, i) => (i === place ? number : other));

/** Metres per unit of depth are those of `depthScale`, behind the form. */
const cameras: Record<string, readonly [json: unknown, depthScale?: number]> = {
  "our own": [{ ...intrinsics, depthScale: 0.0001 }, 0.0001],
  "RealSense's": [{ ...realSense, ...size, model: "brown_conrady", depth_scale: 0.00025 }, 0.00025],
  "K alone, in rows": [rows],
  "K times 2": [{ K: K.map((number) => 2 * number) }],
  "K with a skew of less than half a pixel": [{ K: withNumber(K, 1, 0.4) }],
  "Open3D's, column by column": [
    { ...size, intrinsic_matrix: columns, depth_format: "Z16", depth_scale: 1000, fps: 30, stream_length_usec: 9 },
    0.001,
  ],
  "BOP's whole file": [{ "0": { cam_K: K, cam_R_w2c: K, cam_t_w2c: [1, 2, 3], depth_scale: 0.1 } }, 0.0001],
  "BOP's data set": [{ ...intrinsics, ...size, depth_scale: 1 }, 0.001],
  "BOP's names, in metres": [{ cam_K: K, depth_scale: 0.001 }, 0.001],
  "units per metre": [{ ...intrinsics, depth_scale: 5000 }, 0.0002],
  "ROS 1": [{ header: { seq: 1 }, ...size, distortion_model: "plumb_bob", D: none, K, R: [1], P: K, binning_x: 0 }],
  "ROS 2": [{ ...size, d: [], k: K }],
  "ROS, a region of the sensor": [{ ...sensor, roi: { x_offset: 320, y_offset: 120, width: 640, height: 480 } }],
  "ROS, binned": [
    { ...size, width: 1280, height: 960, K: [1200, 0, 639.5, 0, 1220, 479.5, 0, 0, 1], binning_x: 2, binning_y: 2 },
  ],
  "four numbers": [[600, 610, 319.5, 239.5]],
  "OneViewAll's and VGGT's": [{ intrinsic: [rows], extrinsic: [still] }],
  "a projection of 3 × 4": [{ intrinsics: rows.map((row) => [...row, 0]) }],
  "a projection of 4 × 4, flat": [{ cam_K: [...rows.flatMap((row) => [...row, 0]), 0, 0, 0, 1] }],
  "Record3D's, column by column": [
    {
      w: 640,
      h: 480,
      dw: 192,
      dh: 256,
      fps: 60,
      K: columns,
      poses: [still],
      initPose: [0, 1],
      perFrameIntrinsicCoeffs: [[1]],
    },
  ],
  "ARKit's, column by column": [{ intrinsics: [columns.slice(0, 3), columns.slice(3, 6), columns.slice(6)] }],
  "Polycam's": [{ ...intrinsics, ...size, t_00: 1, t_13: 2, blur_score: 3, timestamp: 9, center_depth: 2 }],
  "nerfstudio's": [
    {
      ...fromEdge,
      k1: 0,
      p1: 0,
      aabb_scale: 16,
      frames: [{ transform_matrix: still }],
      depth_unit_scale_factor: 0.002,
    },
    0.002,
  ],
  "nerfstudio's, a camera for each frame": [
    { camera_model: "OPENCV", frames: [fromEdge, { ...fromEdge, transform_matrix: still }] },
  ],
  "RealSense's, nested": [{ intrinsics: { ...realSense, ...size } }],
  "Open3D's, nested": [{ intrinsic: { ...size, intrinsic_matrix: columns }, extrinsic: [1] }],
  "OpenCV's": [{ camera_matrix: { rows: 3, cols: 3, data: K }, image_width: 640, image_height: 480 }],
  "OpenCV's tutorial": [{ ret: 0.3, mtx: rows, dist: [none], rvecs: [[1]], tvecs: [[2]] }],
  "ZED's": [
    { left_cam: { ...intrinsics, disto: none, image_size: size }, right_cam: { ...intrinsics, cx: 320 }, baseline: 12 },
  ],
  "DepthAI's, the camera of the image's size": [
    {
      boardName: "OAK",
      cameraData: [
        [0, other],
        [1, { intrinsicMatrix: rows, distortionCoeff: none, ...size, lensPosition: 9 }],
      ],
    },
  ],
  "DOPE's": [
    { camera_data: { ...size, intrinsics, quaternion_xyzw_worldframe: [0, 0, 0, 1] }, objects: [{ location: [1] }] },
  ],
  "NDDS's": [
    { camera_settings: [{ horizontal_fov: 64, intrinsic_settings: { resX: 640, resY: 480, ...intrinsics, s: 0 } }] },
  ],
  "HOPE's": [{ camera: { intrinsics: rows, extrinsics: still }, objects: [] }],
  "Replica's": [{ camera: { ...intrinsics, w: 640, h: 480, scale: 6553.5 } }, 1 / 6553.5],
  "GraspNet's": [{ intrinsic_matrix: rows, factor_depth: [[1000]].flat()[0] }, 0.001],
  "MATLAB's": [
    {
      FocalLength: [600, 610],
      PrincipalPoint: [320.5, 240.5],
      ImageSize: [480, 640],
      RadialDistortion: [0, 0],
      Skew: 0,
    },
  ],
  "Unity's": [
    { focalLength: { x: 600, y: 610 }, principalPoint: { x: 319.5, y: 239.5 }, resolution: { x: 640, y: 480 } },
  ],
  "DUSt3R's": [{ focals: [[600, 610]], principal_points: [[319.5, 239.5]] }],
  "a name that is not known": [{ my_camera: rows }],
  "MoGe's, in image sizes": [
    {
      intrinsics: [
        [600 / 640, 0, 0.5],
        [0, 610 / 480, 0.5],
        [0, 0, 1],
      ],
    },
  ],
  "of an image twice as large": [{ fx: 1200, fy: 1220, cx: 639.5, cy: 479.5, width: 1280, height: 960 }],
};

const lines = (name: string, numbers: number[]) =>
  `${name}:\n${numbers.map((number) => `- ${number.toFixed(1)}\n`).join("")}`;

const texts: Record<string, readonly [text: string, depthScale?: number]> = {
  "rows with spaces": ["600 0 319.5\n0 610 239.5\n0 0 1\n"],
  "rows with commas": ["600.0, 0.0, 319.5\r\n0.0, 610.0, 239.5\r\n0.0, 0.0, 1.0"],
  "as numpy.savetxt writes it": [K.map((number) => number.toExponential(18)).join(" ")],
  "as NumPy prints it": ["[[600.    0.  319.5]\n [  0.  610.  239.5]\n [  0.    0.    1. ]]"],
  "as Python prints it": [
    "{'K': array([[600., 0., 319.5],\n [0., 610., 239.5], [0., 0., 1.]], dtype=float32), 'dist': None}",
  ],
  "four numbers": ["600;610;319.5;239.5"],
  "with the names of columns": ["fx,fy,cx,cy\n600,610,319.5,239.5\n"],
  "4 × 4": ["600 0 319.5 0\n0 610 239.5 0\n0 0 1 0\n0 0 0 1\n"],
  names: ["fx = 600\nfy: 610\ncx=319.5, cy=239.5"],
  "FoundationStereo's": [`${K.join(" ")}\n0.063\n`],
  "ARKitScenes'": ["640 480 600 610 319.5 239.5"],
  "COLMAP's": ["# Camera list\n1 PINHOLE 640 480 600 610 320 240\n"],
  "COLMAP's, the camera of the image's size": [
    "1 OPENCV 640 480 600 610 320 240 0 0 0 0\n2 SIMPLE_RADIAL 800 600 500 400 300 0.1\n",
  ],
  "RealSense's, printed": ["[ 640x480  p[319.5 239.5]  f[600 610]  Brown Conrady [0 0 0 0 0] ]"],
  "ROS 2, printed": [
    `header:\n  stamp:\n    sec: 9\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\n${lines("d", none)}${lines("k", K)}${lines("p", K)}roi:\n  height: 0\n  width: 0\n---\nheight: 1\n`,
  ],
  "Kalibr's": [
    `cam0:\n  camera_model: pinhole\n  intrinsics: [600, 610, 319.5, 239.5]\n  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [640, 480]\n  T_cam_imu:\n  - [1.0, 0.0]\n  - [0.0, 1.0]\n`,
  ],
  "ORB-SLAM's": [
    "%YAML:1.0\n# comment\nCamera1.fx: 600.\nCamera1.fy: 610.\nCamera1.cx: 319.5\nCamera1.cy: 239.5\nCamera1.k1: 0.0\nCamera.width: 640\nCamera.height: 480\nCamera.bf: 40\nRGBD.DepthMapFactor: 5000.0\nViewer.PointSize: 2\n",
    0.0002,
  ],
  "NICE-SLAM's": [
    "cam:\n  H: 480\n  W: 640\n  fx: 600\n  fy: 610\n  cx: 319.5\n  cy: 239.5\n  png_depth_scale: 6553.5 # PNG\n",
    1 / 6553.5,
  ],
  "MonoGS'": [
    "Dataset:\n  pcd_downsample: 32\n  point_size: 0.05\n  Calibration:\n    fx: 600\n    fy: 610\n    cx: 319.5\n    cy: 239.5\n    width: 640\n    height: 480\n    depth_scale: 6553.5\nopt_params:\n  iterations: 30000\n",
    1 / 6553.5,
  ],
  "ZED's, the section of the image's size": [
    "[LEFT_CAM_HD]\nfx=900\nfy=900\ncx=640\ncy=360\n[LEFT_CAM_SVGA]\nfx=900\nfy=900\ncx=480\ncy=300\n[SMALL]\nfx=600\nfy=610\ncx=319.5\ncy=239.5\nwidth=640\nheight=480\n[STEREO]\nBaseline=120\n",
  ],
  "Middlebury's": [
    "cam0=[600 0 319.5; 0 610 239.5; 0 0 1]\ncam1=[600 0 330; 0 610 239.5; 0 0 1]\ndoffs=10.5\nwidth=640\nheight=480\n",
  ],
  "OpenCV's YAML": [
    "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 600., 0., 319.5, 0.,\n       610., 239.5, 0., 0., 1. ]\n",
  ],
  "ROS, in braces": [
    "{header: {seq: 1}, height: 480, width: 640, K: [600.0, 0, 319.5, 0, 610.0, 239.5, 0, 0, 1], D: []}",
  ],
  "Metashape's": [
    "<calibration><width>640</width><height>480</height><f>600</f><fy>610</fy><cx>0.0</cx><cy>0</cy></calibration>",
  ],
  "OpenCV's XML": [
    `<?xml version="1.0"?>\n<opencv_storage>\n<camera_matrix type_id="opencv-matrix">\n  <rows>3</rows><data>\n ${K.join(" ")}</data></camera_matrix>\n</opencv_storage>`,
  ],
};

async function readsAs(file: unknown, name: string, depthScale?: number) {
  const found = await readCamera(file as string, size);
  const { width: _, height: __, ...camera } = found;
  assert.deepEqual(camera, { ...intrinsics, ...(depthScale === undefined ? {} : { depthScale }), warnings: [] }, name);
}

test("cameras as text are the same camera, without a doubt", async () => {
  for (const [name, [text, depthScale]] of Object.entries(texts)) {
    for (const file of [text, Buffer.from(text)]) await readsAs(file, name, depthScale);
  }
});

test("cameras of every tool are the same camera, as bytes, text, Blob and object, without a doubt", async () => {
  for (const [name, [json, depthScale]] of Object.entries(cameras)) {
    const text = JSON.stringify(json);
    const forms = [text, `\ufeff${text}`, Buffer.from(text), Buffer.from(`\ufeff${text}`), new Blob([text]), json];
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
  for (const [name, [json]] of Object.entries(cameras)) {
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
