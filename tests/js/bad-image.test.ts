/** Bad depth maps, masks and cameras: a typed error that says what to do, and an aligner that works on. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { AlignInput } from "sim3align";
import { aligner, changed, refusesInputs } from "../support/bad-input.js";
import { codesOf, type Refusals, rejectsWith } from "../support/errors.js";
import { input, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const pixels = width * height;
const filled = (value: number) => depth.map((z, i) => (mask[i] === 0 ? z : value));
const tiny = mask.map((m, i) => (m !== 0 && i < mask.indexOf(1) + 5 ? 1 : 0));

const images: Refusals<object> = {
  "depth missing: INVALID_ARGUMENT depth": [{ depth: undefined }, /found nothing, expected a Float32Array/],
  "depth as a plain array: INVALID_ARGUMENT depth": [
    { depth: Array.from(depth) },
    /plain array of 19200.*Float32Array\.from\(depth\)/,
  ],
  "depth as doubles: INVALID_ARGUMENT depth": [
    { depth: Float64Array.from(depth) },
    /Float64Array.*Float32Array\.from\(depth\)/,
  ],
  "depth in an object, as a plain array: INVALID_ARGUMENT depth.data": [
    { depth: { data: [1], width: 1, height: 1 } },
    /Float32Array\.from/,
  ],
  "8-bit depth: EIGHT_BIT_DEPTH depth": [{ depth: new Uint8Array(pixels).fill(9) }, /256 levels/],
  "depth too short: WRONG_LENGTH depth": [{ depth: depth.slice(1) }, /19199 values.*160 × 120 = 19200/],
  "depth of no size: EMPTY_IMAGE depth": [{ depth: new Float32Array(0), width: 0, height: 0 }, /0 × 0 pixels/],
  "width missing: INVALID_ARGUMENT width": [{ width: undefined }, /nothing/],
  "width as a fraction: INVALID_ARGUMENT width": [{ width: 160.5 }, /160\.5/],
  "width as text: INVALID_ARGUMENT width": [{ width: "160" }, /string/],
  "width as NaN: INVALID_ARGUMENT width": [{ width: Number.NaN }, /NaN/],
  "sizes that contradict: SIZE_MISMATCH depth": [
    { depth: { data: depth, width, height }, width: 99 },
    /160 × 120 pixels.*99 × 120/,
  ],
  "an absurd size: INVALID_ARGUMENT width": [{ width: 4e9, height: 4e9 }, /4000000000/],
  "a depth scale of zero: INVALID_ARGUMENT depthScale": [{ depthScale: 0 }, /found 0/],
  "a depth scale as text: INVALID_ARGUMENT depthScale": [{ depthScale: "mm" }, /string/],
  "a misspelt property: INVALID_ARGUMENT input.depth_scale": [{ depth_scale: 0.001 }, /depthScale/],
  "mask missing: INVALID_ARGUMENT mask": [{ mask: undefined }, /found nothing, expected a Uint8Array/],
  "mask as a plain array: INVALID_ARGUMENT mask": [{ mask: Array.from(mask) }, /Uint8Array\.from\(mask\)/],
  "mask as floats: INVALID_ARGUMENT mask": [{ mask: Float32Array.from(mask) }, /Uint8Array\.from\(mask\)/],
  "mask too short: WRONG_LENGTH mask": [{ mask: mask.slice(1) }, /19199 values.*160 × 120/],
  "an RGBA mask: WRONG_LENGTH mask": [
    { mask: new Uint8ClampedArray(4 * pixels) },
    /76800 values, 4 per pixel.*19200 values, one.*one channel of the RGBA image/,
  ],
  "an RGB mask in an object: WRONG_LENGTH mask.data": [
    { mask: { data: new Uint8Array(3 * pixels), width, height } },
    /3 per pixel.*i % 3 === 0/,
  ],
  "a mask as ImageData: INVALID_ARGUMENT mask": [
    { mask: { [Symbol.toStringTag]: "ImageData" } },
    /found ImageData.*one channel/,
  ],
  "mask of another size: SIZE_MISMATCH mask": [
    { mask: { data: new Uint8Array(80 * 60), width: 80, height: 60 } },
    /80 × 60 pixels.*160 × 120.*resizeMask/s,
  ],
  "an unknown way of resizing: INVALID_ARGUMENT resizeMask": [{ resizeMask: "bilinear" }, /"nearest"/],
  "mask empty: EMPTY_MASK mask": [{ mask: new Uint8Array(pixels) }, /no non-zero pixel/],
  "mask without depth: NO_DEPTH_IN_MASK depth": [{ depth: filled(0) }, /no reading in the \d+ pixels/],
  "mask with NaN depth: NO_DEPTH_IN_MASK depth": [{ depth: filled(Number.NaN) }, /no reading/],
  "depth all equal: FLAT_DEPTH depth": [{ depth: filled(0.7) }, /0\.7 m in all \d+ readings/],
  "too few points: TOO_FEW_POINTS depth": [{ mask: tiny }, /at least \d+/],
  "camera as a number: INVALID_ARGUMENT camera": [{ camera: 600 }, /number 600/],
  "camera as null: INVALID_ARGUMENT camera": [{ camera: null }, /null/],
  "camera with NaN: INVALID_CAMERA camera.cx": [{ camera: { ...camera, cx: Number.NaN } }, /NaN/],
  "camera with fx of zero: INVALID_CAMERA camera.fx": [{ camera: { ...camera, fx: 0 } }, /found 0/],
  "camera with negative fy: INVALID_CAMERA camera.fy": [{ camera: { ...camera, fy: -600 } }, /-600/],
  "camera with fx missing: INVALID_ARGUMENT camera.fx": [
    { camera: { fy: 1, cx: 1, cy: 1, fx: undefined } },
    /nothing|undefined/,
  ],
  "K column by column: INVALID_CAMERA camera.K": [{ camera: { K: [300, 0, 0, 0, 300, 0, 80, 60, 1] } }, /transpose/],
  "K of eight numbers: WRONG_LENGTH camera.K": [{ camera: { K: [1, 2, 3, 4, 5, 6, 7, 8] } }, /9 numbers|3 × 3|3×3/],
  "a field of view of 180°: INVALID_CAMERA camera.fovYDeg": [{ camera: { fovYDeg: 180 } }, /below 180/],
  "a camera of another image: SIZE_MISMATCH camera": [
    { camera: { ...camera, width: 640, height: 480 } },
    /640 × 480.*160 × 120/,
  ],
  "a camera file as camera: INVALID_ARGUMENT camera": [{ camera: { cam_K: [] } }, /cameraFile/],
  "a camera with other names: INVALID_ARGUMENT camera": [
    { camera: { focal: 600 } },
    /found an object with focal, expected \{ fx, fy, cx, cy \}.* Rename or omit `focal`/,
  ],
  "camera text: INVALID_ARGUMENT camera": [{ camera: "{}" }, /cameraFile/],
  "camera and camera file: INVALID_ARGUMENT cameraFile": [{ cameraFile: "{}" }, /not both/],
  "camera file text that is no JSON: CORRUPT_FILE cameraFile": [{ camera: undefined, cameraFile: "fx=600" }, /JSON/],
  "a camera file with a focal length of 0: INVALID_CAMERA cameraFile.fx": [
    { camera: undefined, cameraFile: { ...camera, fx: 0 } },
    /found 0/,
  ],
  "a scene camera without image id: INVALID_ARGUMENT imageId": [
    { camera: undefined, cameraFile: { "1": { cam_K: [] }, "2": { cam_K: [] } } },
    /one of 1, 2/,
  ],
};

refusesInputs(images);

test("no input at all", async () => {
  for (const nothing of [undefined, null, 5, "case", []]) {
    await rejectsWith(
      () => aligner.align(nothing as unknown as AlignInput),
      "INVALID_ARGUMENT input",
      /depth, mask, mesh, camera/,
    );
  }
});

test("millimetres passed as metres are warned of", async () => {
  const millimetres = { ...input, depth: depth.map((z) => 1000 * z) };
  const inMillimetres = { ...truth, scale: 1000 * truth.scale, translation: truth.translation.map((x) => 1000 * x) };
  const { warnings } = await aligner.evaluate(millimetres, inMillimetres);
  assert.deepEqual(codesOf(warnings), ["DEPTH_LOOKS_LIKE_MILLIMETRES"]);
  assert.match(warnings[0]?.message ?? "", /0\.001/);
});

test("a mask at the border and sparse depth are warned of", async () => {
  const sparse = depth.map((z, i) => (mask[i] !== 0 && i % 3 > 0 ? 0 : z));
  const atBorder = changed(mask, 0, 1);
  const { warnings } = await aligner.evaluate({ ...input, depth: sparse, mask: atBorder }, truth);
  assert.deepEqual(codesOf(warnings).sort(), ["MASK_TOUCHES_BORDER", "SPARSE_DEPTH"]);
});

test("evaluate checks its input as align does", async () => {
  for (const argument of ["depth", "mesh"]) {
    const wrong: unknown = { ...input, [argument]: undefined };
    await rejectsWith(() => aligner.evaluate(wrong as AlignInput, truth), `INVALID_ARGUMENT ${argument}`, /nothing/);
  }
});
