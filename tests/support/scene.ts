/**
 * A small scene, made independently of the package: an uneven blob, posed and seen by a pinhole camera through a ray
 * caster.
 */

/** A triangle mesh. */
export interface Mesh {
  positions: Float32Array;
  indices: Uint32Array;
}

/** y = scale · R · x + translation; the quaternion is x, y, z, w. */
export interface Pose {
  scale: number;
  rotation: [number, number, number, number];
  translation: [number, number, number];
}

/** Pixels, OpenCV convention. */
export interface Pinhole {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

type Vec3 = [number, number, number];

/** What a depth camera sees. */
export interface View {
  width: number;
  height: number;
  depth: Float32Array;
  mask: Uint8Array;
  camera: Pinhole;
}

/** A closed surface without symmetry, about two units across. */
export function blob(rings = 40, sectors = 60): Mesh {
  const positions: number[] = [];
  const push = (theta: number, phi: number) => {
    const [x, y, z] = [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
    const bump = (a: number, b: number, c: number, sharpness: number) =>
      Math.exp(sharpness * ((x * a + y * b + z * c) / Math.hypot(a, b, c) - 1));
    const radius = 0.6 + 0.5 * bump(1, 0.2, 0.3, 8) + 0.35 * bump(-0.3, 1, 0.5, 12) + 0.4 * bump(0.2, -0.6, 1, 5);
    positions.push(radius * x, 0.8 * radius * y, 1.2 * radius * z);
  };
  push(0, 0);
  for (let i = 1; i < rings; i++) {
    for (let j = 0; j < sectors; j++) push((Math.PI * i) / rings, (2 * Math.PI * j) / sectors);
  }
  push(Math.PI, 0);
  const last = positions.length / 3 - 1;
  const at = (i: number, j: number) => (i === 0 ? 0 : i === rings ? last : 1 + (i - 1) * sectors + (j % sectors));
  const indices: number[] = [];
  for (let i = 0; i < rings; i++) {
    for (let j = 0; j < sectors; j++) {
      if (i > 0) indices.push(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i < rings - 1) indices.push(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

/** The rotation by the second quaternion, then by the first. */
export function product([a, b, c, d]: Pose["rotation"], [x, y, z, w]: Pose["rotation"]): Pose["rotation"] {
  return [
    d * x + a * w + b * z - c * y,
    d * y - a * z + b * w + c * x,
    d * z + a * y - b * x + c * w,
    d * w - a * x - b * y - c * z,
  ];
}

/** The rotation's rows. */
export function rotationRows([x, y, z, w]: Pose["rotation"]): [Vec3, Vec3, Vec3] {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
  ];
}

/** The pose as `gt.json` has it, of an object without symmetry. */
export const poseJson = ({ scale, rotation, translation }: Pose) => ({
  ...{ available: true, scale, rotation: rotationRows(rotation), translation, symmetry: "none" },
});

/** The pose's 16 numbers, column by column. */
export function columnMajor({ scale, rotation, translation }: Pose): number[] {
  const rows = rotationRows(rotation);
  const column = (j: 0 | 1 | 2) => [...rows.map((row) => scale * row[j]), 0];
  return [...column(0), ...column(1), ...column(2), ...translation, 1];
}

/** Points, x, y, z one after the other, moved by the pose. */
export function transformed(points: ArrayLike<number>, { scale, rotation, translation }: Pose): Float64Array {
  const rows = rotationRows(rotation);
  const result = new Float64Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    for (const k of [0, 1, 2] as const) {
      const [a, b, c] = rows[k];
      const turned = a * (points[i] ?? 0) + b * (points[i + 1] ?? 0) + c * (points[i + 2] ?? 0);
      result[i + k] = scale * turned + translation[k];
    }
  }
  return result;
}

const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** Where the ray through the camera's centre with this direction (z = 1) meets the triangle: its depth, or infinity. */
function intersection(ray: Vec3, [a, b, c]: readonly [Vec3, Vec3, Vec3]): number {
  const [ab, ac] = [sub(b, a), sub(c, a)];
  const p = cross(ray, ac);
  const determinant = dot(ab, p);
  if (determinant === 0) return Number.POSITIVE_INFINITY;
  const toOrigin: Vec3 = [-a[0], -a[1], -a[2]];
  const u = dot(toOrigin, p) / determinant;
  const q = cross(toOrigin, ab);
  const v = dot(ray, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1) return Number.POSITIVE_INFINITY;
  return dot(ac, q) / determinant;
}

/** Casts a ray through each pixel. A wall behind the object fills the rest of the depth map. */
export function render(mesh: Mesh, pose: Pose, camera: Pinhole, width: number, height: number, wallM = 1.5): View {
  const posed = transformed(mesh.positions, pose);
  const vertex = (i: number): Vec3 => [posed[3 * i] ?? 0, posed[3 * i + 1] ?? 0, posed[3 * i + 2] ?? 0];
  const depth = new Float32Array(width * height).fill(wallM);
  const mask = new Uint8Array(width * height);
  for (let t = 0; t < mesh.indices.length; t += 3) {
    const corner = (k: number) => vertex(mesh.indices[t + k] ?? 0);
    const triangle = [corner(0), corner(1), corner(2)] as const;
    const us = triangle.map(([x, , z]) => camera.cx + (camera.fx * x) / z);
    const vs = triangle.map(([, y, z]) => camera.cy + (camera.fy * y) / z);
    for (let v = Math.max(0, Math.ceil(Math.min(...vs))); v <= Math.min(height - 1, Math.max(...vs)); v++) {
      for (let u = Math.max(0, Math.ceil(Math.min(...us))); u <= Math.min(width - 1, Math.max(...us)); u++) {
        const z = intersection([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1], triangle);
        const pixel = v * width + u;
        if (z <= 0 || z >= (depth[pixel] ?? 0)) continue;
        depth[pixel] = z;
        mask[pixel] = 1;
      }
    }
  }
  return { width, height, depth, mask, camera };
}

/** Where the blob of {@link view} is: 0.09 m per unit, 0.7 m away. */
export const truth: Pose = {
  scale: 0.09,
  rotation: normalized([0.3, -0.5, 0.2, 0.8]),
  translation: [0.02, -0.01, 0.7],
};

/** Poses that differ from the test scene's in place, size and turn. */
export function otherPose(i: number): Pose {
  const [x, y, z] = truth.translation;
  const half = 0.2 * i;
  const rotation: Pose["rotation"] = [0.6 * Math.sin(half), 0.8 * Math.sin(half), 0, Math.cos(half)];
  return { scale: truth.scale * (1 + 0.01 * i), rotation, translation: [x + 0.002 * i, y, z + 0.01 * i] };
}

function normalized(q: Pose["rotation"]): Pose["rotation"] {
  const length = Math.hypot(...q);
  return q.map((x) => x / length) as Pose["rotation"];
}

/** The blob. */
export const mesh = blob();

/** The camera of {@link view}. */
export const pinhole: Pinhole = { fx: 300, fy: 301, cx: 79.5, cy: 60 };

/** The blob at the truth, as a camera of 160 × 120 pixels sees it. */
export const view = render(mesh, truth, pinhole, 160, 120);

/** A mesh at the truth, seen by the same camera, as an input of bare typed arrays. */
function scene(object: Mesh) {
  return { ...render(object, truth, pinhole, 160, 120), mesh: object };
}

/** The scene as an input of bare typed arrays. */
export const input = scene(mesh);

/** A brick at the truth: half a turn about any of its axes leaves it as it is. */
export const brick = scene(cuboid(1, 0.7, 0.4));

/** A cuboid around the origin. */
export function cuboid(x: number, y: number, z: number): Mesh {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z]);
  const sides = ["0132", "4576", "0451", "2376", "0264", "1375"].map((side) => Array.from(side, Number));
  const indices = sides.flatMap(([a = 0, b = 0, c = 0, d = 0]) => [a, b, c, a, c, d]);
  return { positions: Float32Array.from(corners), indices: Uint32Array.from(indices) };
}
