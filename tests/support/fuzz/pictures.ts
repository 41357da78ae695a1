/** Small scenes in every form that the package reads. They are rendered once. */
import { cocoRle, glb, maskPng, npy, obj, png } from "../files.js";
import type { Random } from "../random.js";
import { blob, render, truth } from "../scene.js";
import { pick } from "./odd-values.js";

const mesh = blob(7, 9);
const sizes = [
  [16, 12],
  [32, 24],
  [40, 30],
] as const;
const views = sizes.map(([width, height]) =>
  render(mesh, truth, { fx: 1.9 * width, fy: 1.9 * width, cx: (width - 1) / 2, cy: (height - 1) / 2 }, width, height),
);

/** A scene that `align` can solve, with copies of all arrays. */
export function randomPicture(random: Random): Record<string, unknown> {
  const { width, height, depth, mask, camera } = pick(random, views);
  const { fx, fy, cx, cy } = camera;
  const size = { width, height };
  const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));
  const depths = [
    { depth: depth.slice(), ...size },
    { depth: { data: depth.slice(), ...size } },
    { depth: millimetres, ...size, depthScale: 0.001 },
    { depth: npy(depth, height, width) },
    { depth: png(millimetres, width, height) },
    { depth: depth.map((z) => 3 / z - 1), ...size, depthKind: "affine-invariant-disparity" },
    { depth: depth.map((z) => 5 * z - 1), ...size, depthKind: "affine-invariant" },
  ];
  const masks = [
    mask.slice(),
    Uint8ClampedArray.from(mask),
    { data: mask.slice(), ...size },
    cocoRle(mask, width, height),
    maskPng(mask, width, height),
  ];
  const cameras = [
    { camera: { ...camera } },
    { camera: { K: [fx, 0, cx, 0, fy, cy, 0, 0, 1] } },
    { camera: { K: Float64Array.of(fx, 0, cx, 0, fy, cy, 0, 0, 1) } },
    { camera: { fovYDeg: 30 } },
    { camera: { ...camera, focalUncertainty: 0.2 } },
    { camera: { ...size } },
    {},
    { cameraFile: JSON.stringify(camera) },
    { cameraFile: { "1": { cam_K: [fx, 0, cx, 0, fy, cy, 0, 0, 1], depth_scale: 1 } } },
  ];
  const meshes = [
    { positions: mesh.positions.slice(), indices: mesh.indices.slice() },
    { positions: mesh.positions.slice(), indices: Uint16Array.from(mesh.indices) },
    glb(mesh),
    { bytes: glb(mesh), format: "glb" },
    obj(mesh),
  ];
  return { ...pick(random, depths), mask: pick(random, masks), ...pick(random, cameras), mesh: pick(random, meshes) };
}
