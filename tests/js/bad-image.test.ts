/** Bad depth maps, masks and cameras: a typed error that says what to do, and an aligner that works on. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { AlignInput } from "sim3align";
import { aligner, type Bad, changed, refuses } from "../support/bad-input.js";
import { rejectsWith } from "../support/errors.js";
import { input, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const pixels = width * height;
const filled = (value: number) => depth.map((z, i) => (mask[i] === 0 ? z : value));
const tiny = mask.map((m, i) => (m !== 0 && i < mask.indexOf(1) + 5 ? 1 : 0));

const images: Bad[] = [
  ["depth missing", { depth: undefined }, "INVALID_ARGUMENT", "depth", /found nothing, expected a Float32Array/],
  [
    "depth as a plain array",
    { depth: Array.from(depth) },
    "INVALID_ARGUMENT",
    "depth",
    /plain array of 19200.*Float32Array\.from\(depth\)/,
  ],
  [
    "depth as doubles",
    { depth: Float64Array.from(depth) },
    "INVALID_ARGUMENT",
    "depth",
    /Float64Array.*Float32Array\.from\(depth\)/,
  ],
  [
    "depth in an object, as a plain array",
    { depth: { data: [1], width: 1, height: 1 } },
    "INVALID_ARGUMENT",
    "depth.data",
    /Float32Array\.from/,
  ],
  ["8-bit depth", { depth: new Uint8Array(pixels).fill(9) }, "EIGHT_BIT_DEPTH", "depth", /256 levels/],
  ["depth too short", { depth: depth.slice(1) }, "WRONG_LENGTH", "depth", /19199 values.*160 × 120 = 19200/],
  ["depth of no size", { depth: new Float32Array(0), width: 0, height: 0 }, "EMPTY_IMAGE", "depth", /0 × 0 pixels/],
  ["width missing", { width: undefined }, "INVALID_ARGUMENT", "width", /nothing/],
  ["width as a fraction", { width: 160.5 }, "INVALID_ARGUMENT", "width", /160\.5/],
  ["width as text", { width: "160" }, "INVALID_ARGUMENT", "width", /string/],
  ["width as NaN", { width: Number.NaN }, "INVALID_ARGUMENT", "width", /NaN/],
  [
    "sizes that contradict",
    { depth: { data: depth, width, height }, width: 99 },
    "SIZE_MISMATCH",
    "depth",
    /160 × 120 pixels.*99 × 120/,
  ],
  ["an absurd size", { width: 4e9, height: 4e9 }, "INVALID_ARGUMENT", "width", /4000000000/],
  ["a depth scale of zero", { depthScale: 0 }, "INVALID_ARGUMENT", "depthScale", /found 0/],
  ["a depth scale as text", { depthScale: "mm" }, "INVALID_ARGUMENT", "depthScale", /string/],
  ["a misspelt property", { depth_scale: 0.001 }, "INVALID_ARGUMENT", "input.depth_scale", /depthScale/],
  ["mask missing", { mask: undefined }, "INVALID_ARGUMENT", "mask", /found nothing, expected a Uint8Array/],
  ["mask as a plain array", { mask: Array.from(mask) }, "INVALID_ARGUMENT", "mask", /Uint8Array\.from\(mask\)/],
  ["mask as floats", { mask: Float32Array.from(mask) }, "INVALID_ARGUMENT", "mask", /Uint8Array\.from\(mask\)/],
  ["mask too short", { mask: mask.slice(1) }, "WRONG_LENGTH", "mask", /19199 values.*160 × 120/],
  [
    "an RGBA mask",
    { mask: new Uint8ClampedArray(4 * pixels) },
    "WRONG_LENGTH",
    "mask",
    /76800 values, 4 per pixel.*19200 values, one.*one channel of the RGBA image/,
  ],
  [
    "an RGB mask in an object",
    { mask: { data: new Uint8Array(3 * pixels), width, height } },
    "WRONG_LENGTH",
    "mask.data",
    /3 per pixel.*i % 3 === 0/,
  ],
  [
    "a mask as ImageData",
    { mask: { [Symbol.toStringTag]: "ImageData" } },
    "INVALID_ARGUMENT",
    "mask",
    /found ImageData.*one channel/,
  ],
  [
    "mask of another size",
    { mask: { data: new Uint8Array(80 * 60), width: 80, height: 60 } },
    "SIZE_MISMATCH",
    "mask",
    /80 × 60 pixels.*160 × 120.*resizeMask/s,
  ],
  ["an unknown way of resizing", { resizeMask: "bilinear" }, "INVALID_ARGUMENT", "resizeMask", /"nearest"/],
  ["mask empty", { mask: new Uint8Array(pixels) }, "EMPTY_MASK", "mask", /no non-zero pixel/],
  ["mask without depth", { depth: filled(0) }, "NO_DEPTH_IN_MASK", "depth", /no reading in the \d+ pixels/],
  ["mask with NaN depth", { depth: filled(Number.NaN) }, "NO_DEPTH_IN_MASK", "depth", /no reading/],
  ["depth all equal", { depth: filled(0.7) }, "FLAT_DEPTH", "depth", /0\.7 m in all \d+ readings/],
  ["too few points", { mask: tiny }, "TOO_FEW_POINTS", "depth", /at least \d+/],
  ["camera missing", { camera: undefined }, "INVALID_ARGUMENT", "camera", /found nothing/],
  ["camera as a number", { camera: 600 }, "INVALID_ARGUMENT", "camera", /number 600/],
  ["camera with NaN", { camera: { ...camera, cx: Number.NaN } }, "INVALID_CAMERA", "camera.cx", /NaN/],
  ["camera with fx of zero", { camera: { ...camera, fx: 0 } }, "INVALID_CAMERA", "camera.fx", /found 0/],
  ["camera with negative fy", { camera: { ...camera, fy: -600 } }, "INVALID_CAMERA", "camera.fy", /-600/],
  [
    "camera with fx missing",
    { camera: { fy: 1, cx: 1, cy: 1, fx: undefined } },
    "INVALID_ARGUMENT",
    "camera.fx",
    /nothing|undefined/,
  ],
  [
    "K column by column",
    { camera: { K: [300, 0, 0, 0, 300, 0, 80, 60, 1] } },
    "INVALID_CAMERA",
    "camera.K",
    /transpose/,
  ],
  [
    "K of eight numbers",
    { camera: { K: [1, 2, 3, 4, 5, 6, 7, 8] } },
    "WRONG_LENGTH",
    "camera.K",
    /9 numbers|3 × 3|3×3/,
  ],
  ["a field of view of 180°", { camera: { fovYDeg: 180 } }, "INVALID_CAMERA", "camera.fovYDeg", /below 180/],
  [
    "a camera of another image",
    { camera: { ...camera, width: 640, height: 480 } },
    "SIZE_MISMATCH",
    "camera",
    /640 × 480.*160 × 120/,
  ],
  ["a camera file as camera", { camera: { cam_K: [] } }, "INVALID_ARGUMENT", "camera", /cameraFile/],
  [
    "a camera with other names",
    { camera: { focal: 600 } },
    "INVALID_ARGUMENT",
    "camera",
    /found an object with focal, expected \{ fx, fy, cx, cy \}.* Rename or omit `focal`/,
  ],
  ["camera text", { camera: "{}" }, "INVALID_ARGUMENT", "camera", /cameraFile/],
  ["camera and camera file", { cameraFile: "{}" }, "INVALID_ARGUMENT", "cameraFile", /not both/],
  [
    "camera file text that is no JSON",
    { camera: undefined, cameraFile: "fx=600" },
    "CORRUPT_FILE",
    "cameraFile",
    /JSON/,
  ],
  [
    "a camera file with a focal length of 0",
    { camera: undefined, cameraFile: { ...camera, fx: 0 } },
    "INVALID_CAMERA",
    "cameraFile.fx",
    /found 0/,
  ],
  [
    "a scene camera without image id",
    { camera: undefined, cameraFile: { "1": { cam_K: [] }, "2": { cam_K: [] } } },
    "INVALID_ARGUMENT",
    "imageId",
    /one of 1, 2/,
  ],
];

refuses(images);

test("no input at all", async () => {
  for (const nothing of [undefined, null, 5, "case", []]) {
    const call = () => aligner.align(nothing as unknown as AlignInput);
    await rejectsWith(call, { code: "INVALID_ARGUMENT", argument: "input", message: /depth, mask, mesh, camera/ });
  }
});

test("millimetres passed as metres are warned of", async () => {
  const millimetres = { ...input, depth: depth.map((z) => 1000 * z) };
  const inMillimetres = { ...truth, scale: 1000 * truth.scale, translation: truth.translation.map((x) => 1000 * x) };
  const { warnings } = await aligner.evaluate(millimetres, inMillimetres);
  assert.deepEqual(
    warnings.map(({ code }) => code),
    ["DEPTH_LOOKS_LIKE_MILLIMETRES"],
  );
  assert.match(warnings[0]?.message ?? "", /0\.001/);
});

test("a mask at the border and sparse depth are warned of", async () => {
  const sparse = depth.map((z, i) => (mask[i] !== 0 && i % 3 > 0 ? 0 : z));
  const atBorder = changed(mask, 0, 1);
  const { warnings } = await aligner.evaluate({ ...input, depth: sparse, mask: atBorder }, truth);
  assert.deepEqual(warnings.map(({ code }) => code).sort(), ["MASK_TOUCHES_BORDER", "SPARSE_DEPTH"]);
});

test("evaluate checks its input as align does", async () => {
  for (const argument of ["depth", "mesh"]) {
    const wrong: unknown = { ...input, [argument]: undefined };
    const call = () => aligner.evaluate(wrong as AlignInput, truth);
    await rejectsWith(call, { code: "INVALID_ARGUMENT", argument, message: /nothing/ });
  }
});
