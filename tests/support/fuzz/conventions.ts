/** Calls of `sim3align/conventions` with odd arguments. Each must return, or throw an error that callers can handle. */
import * as conventions from "sim3align/conventions";
import type { Random } from "../random.js";
import { blob, columnMajor, truth } from "../scene.js";
import { splatOf, splatPly, splatRecords } from "../splats.js";
import { mutate } from "./mutations.js";
import { oddValue, pick, proxied } from "./odd-values.js";

const mesh = blob(5, 6);
const image = { width: 8, height: 6 };
const count = image.width * image.height;
const depthKinds = ["metric", "scale-invariant", "affine-invariant", "affine-invariant-disparity"];
const turned = { scale: truth.scale, rotation: [0, 0, 0.6, 0.8], translation: [0.1, -0.2, 1.5] };

/** Arguments that the functions take, each made anew: calls and mutations may change them. */
const valid = {
  transform: (random: Random) =>
    pick<() => unknown>(random, [
      () => ({ ...turned }),
      () => ({ matrix: columnMajor(truth) }),
      () => Float64Array.from(columnMajor(truth)),
      () => columnMajor(truth),
    ])(),
  mesh: (random: Random) => ({
    positions: mesh.positions.slice(),
    indices: random.between(0, 1) < 0.8 ? mesh.indices.slice() : null,
  }),
  splats: (random: Random) => pick(random, [splatPly, splatRecords])(splatOf(mesh, 20, 1)),
  glb: () => conventions.exportGlb(mesh, columnMajor(truth)),
  depth: () => ({ data: new Float32Array(count).fill(1.5), ...image }),
  mask: () => ({ data: Uint8Array.from({ length: count }, (_, i) => i % 3), ...image }),
  points: () => ({ data: Float32Array.from({ length: 3 * count }, (_, i) => 1 + i / 99), ...image }),
  size: () => ({ width: 5, height: 4 }),
  camera: () => ({ fx: 12, fy: 12, cx: 3.5, cy: 2.5 }),
  tensor: () => ({ data: new Float32Array(count).fill(0.5), dims: [1, 1, image.height, image.width] }),
  stretch: () => ({
    stretch: [
      [1.1, 0.05, 0],
      [0.05, 0.9, -0.02],
      [0, -0.02, 1.02],
    ],
  }),
  options: () => ({}),
};

type Arguments = readonly (keyof typeof valid | ((random: Random) => unknown))[];

/** The functions with the arguments that they take. */
const table: readonly (readonly [name: keyof typeof conventions, ...args: Arguments])[] = [
  ["toBop", "transform", "options"],
  ["fromBop", () => ({ cam_R_m2c: [1, 0, 0, 0, 1, 0, 0, 0, 1], cam_t_m2c: [1, 2, 900] }), () => ({ scale: 0.001 })],
  ["toCuboid", () => ({ sizeM: [1, 2, 3], centerM: [0, 0, 2], rotation: [0, 0, 0, 1] }), () => ({ frame: "ros" })],
  ["toCvatCuboid", () => ({ center: [0, 0, 2], size: [1, 2, 3], quaternion: [0, 0, 0, 1] })],
  ["fromCvatCuboid", () => [0, 0, 2, 0.1, 0.2, 0.3, 1, 2, 3, 0, 0, 0, 0, 0, 0, 0]],
  ["fromCvatRle", () => [3, 4, 5, 2, 0, 7, 1, 2, 6, 3], () => ({ ...image })],
  ["fromCvatRle", () => ({ rle: "3,4,5", left: 1, top: 1, width: 4, height: 3 }), () => ({ ...image })],
  ["depthFromDisparity", "depth", () => ({ scale: 2, shift: 0.1 })],
  [
    "correctDepth",
    () => ({ data: new Float32Array([0, -1, Number.NaN, 0.5, 1, 2, 1e9, 3, 4]), width: 3, height: 3 }),
    (random) => ({ depthKind: pick(random, depthKinds), scale: 2, shift: -0.1 }),
  ],
  ["toFrame", "transform", (random) => pick(random, ["opencv", "opengl", "ros", "pytorch3d"])],
  ["fromFrame", "transform", (random) => pick(random, ["opencv", "opengl", "ros", "pytorch3d"])],
  ["toThree", "transform"],
  ["toRos", "transform", () => ({ frame: "optical" })],
  ["exportGlb", "mesh", "transform", (random) => ({ mode: pick(random, ["node", "baked"]) })],
  [
    "exportSceneGlb",
    (random) => [
      {
        name: "mug",
        mesh: pick<unknown>(random, [valid.glb(), valid.mesh(random)]),
        transform: valid.transform(random),
      },
      { mesh: valid.mesh(random), transform: valid.transform(random) },
    ],
    () => ({ support: { normal: [0, -1, 0.2], d: 0.4 }, camera: { fy: 500, width: 640, height: 480 } }),
  ],
  ["stretchMesh", "mesh", "stretch"],
  ["stretchGlb", "glb", "stretch"],
  ["uprightMesh", "mesh", "transform", () => ({ support: { normal: [0, -1, 0.2] }, up: "z" })],
  ["uprightGlb", "glb", "mesh", "transform", () => ({ up: "y" })],
  ["placeGlb", "glb", "transform", () => ({ frame: "opencv", name: "mug" })],
  ["placeSplats", "splats", "transform", () => ({ frame: "ros" })],
  ["toGltfNode", "transform", () => ({ metrics: { iou: 0.9 }, name: "mug" })],
  ["fromLabelStudioRle", () => new Uint8Array([0, 0, 0, 192, 58, 8, 0, 1, 255, 7, 9, 9]), () => ({ ...image })],
  ["pointMapFromMoge", () => ({ points: valid.points().data, ...image, intrinsics: [1, 0, 0.5, 0, 1, 0.5, 0, 0, 1] })],
  ["orientedBoundingBox", "mesh", "transform", (random) => ({ box: pick(random, ["axes", "minimal"]) })],
  ["exportPly", "mesh", "transform"],
  [
    "cropInput",
    (random) => ({
      depth: valid.depth(),
      mask: valid.mask(),
      camera: valid.camera(),
      pointMap: pick(random, [undefined, valid.points()]),
    }),
    () => ({ left: 1, top: 1, width: 4, height: 3 }),
  ],
  ["maskBox", "mask", () => ({ marginPx: 2 })],
  ["resizeCamera", "camera", () => ({ width: 4, height: 3, fromWidth: 8, fromHeight: 6 })],
  ["resizeDepth", "depth", "size"],
  ["resizeMask", "mask", "size"],
  ["wxyzFromXyzw", () => [0, 0, 0.6, 0.8]],
  ["xyzwFromWxyz", () => [0.8, 0, 0, 0.6]],
  ["fromSam3d", () => ({ scale: [[2, 2, 2]], rotation: [[0.8, 0, 0, 0.6]], translation: [[0, 0, 1]] }), "options"],
  ["toSam3d", "transform", () => ({ vertices: "glb" })],
  ["applyToPoints", "transform", () => mesh.positions.slice()],
  ["compose", "transform", "transform"],
  ["invert", "transform"],
  ["toRowMajor", "transform"],
  ["toSim3", "transform"],
  ["depthFromTensor", "tensor"],
  ["maskFromTensor", "tensor", () => ({ index: 0 })],
  ["fromCocoRle", () => ({ size: [6, 8], counts: [10, 20, 18] })],
  ["fromCocoRle", () => ({ size: [6, 8], counts: "0T1`0" })],
  ["toCocoRle", "mask"],
];

const functions: Record<string, (...args: unknown[]) => unknown> = { ...(conventions as object) };

/** The names of the functions that are called. */
export const calledNames: readonly string[] = table.map(([name]) => name);

/** An argument that is valid, odd, or something between. */
function argument(random: Random, make: Arguments[number]): unknown {
  if (random.between(0, 1) < 0.08) return oddValue(random);
  // A property of this holder, so that an array or a number can be replaced as well.
  const holder: { value: unknown } = { value: (typeof make === "function" ? make : valid[make])(random) };
  const changes = pick(random, [0, 0, 1, 1, 1, 2, 3]);
  for (let i = 0; i < changes; i++) mutate(random, holder);
  try {
    const { value } = holder;
    return random.between(0, 1) < 0.03 && typeof value === "object" && value !== null ? proxied(random, value) : value;
  } catch {
    // A getter of the holder itself.
    return undefined;
  }
}

/** A call with arguments of this seed. */
export function conventionCall(random: Random): { name: string; call: () => unknown } {
  const [name, ...makes] = pick(random, table);
  const args = makes.map((make) => argument(random, make));
  // Optional arguments may be missing.
  if (random.between(0, 1) < 0.05) args.pop();
  return { name, call: () => functions[name]?.(...args) };
}
