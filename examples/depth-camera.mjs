/**
 * A simulated depth camera over a table, for examples with several frames: it renders what a real one would measure, so that
 * the true poses are known. The world is in metres, z is up, and the table is at z = 0.
 */
import { applyToPoints, compose, invert } from "sim3align/conventions";

/** @typedef {{ mesh: { positions: Float32Array, indices: Uint32Array }, worldFromMesh: number[] }} PlacedMesh */

/** The direction in which the mesh of the sample mug is open. */
export const MUG_UP = [-0.105, -0.76, -0.641];

const size = { width: 320, height: 240 };
const camera = { fx: 300, fy: 300, cx: 159.5, cy: 119.5 };
/** Standard deviation of a reading at 1 m, metres; it grows with the square of the depth. Share of missing readings. */
const NOISE_M = 0.0015;
const MISSING = 0.02;
/** Beyond it the camera has no readings, metres. */
const FARTHEST_M = 2;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** World from camera of a camera at `eye` that looks at `target`: 16 numbers, column-major. */
export function lookAt(eye, target) {
  const forward = unit(target.map((x, i) => x - eye[i]));
  const right = unit(cross(forward, [0, 0, 1]));
  return [...right, 0, ...cross(forward, right), 0, ...forward, 0, ...eye, 1];
}

/** World from mesh of a mesh of this scale that stands on the table, in the middle, with its direction `up` upwards. */
export function standing({ positions }, up, scale) {
  const z = unit(up);
  const x = unit(cross([0, 1, 0], z));
  const rows = [x, cross(z, x), z];
  const coordinates = rows.map((row) => {
    let [least, most] = [Infinity, -Infinity];
    for (let i = 0; i < positions.length; i += 3) {
      const at = scale * dot(row, positions.subarray(i, i + 3));
      [least, most] = [Math.min(least, at), Math.max(most, at)];
    }
    return [least, most];
  });
  const columns = [0, 1, 2].map((column) => [...rows.map((row) => scale * row[column]), 0]);
  const [[left, right], [near, far], [bottom]] = coordinates;
  return [...columns.flat(), -(left + right) / 2, -(near + far) / 2, -bottom, 1];
}

/**
 * What the camera sees: the first object is the one with the mask.
 * @param {PlacedMesh[]} objects
 * @param {number[]} cameraToWorld
 * @param {number} seed of the noise
 */
export function capture(objects, cameraToWorld, seed) {
  const depth = table(cameraToWorld);
  const mask = new Uint8Array(depth.length);
  for (const [k, { mesh, worldFromMesh }] of objects.entries()) {
    const cameraFromMesh = compose(invert({ matrix: cameraToWorld }), { matrix: worldFromMesh });
    draw(depth, mask, applyToPoints(cameraFromMesh, mesh.positions), mesh.indices, k === 0 ? 1 : 0);
  }
  const random = generator(seed);
  for (let i = 0; i < depth.length; i++) {
    const normal = 2 * (random() + random() + random()) - 3;
    depth[i] = random() < MISSING ? 0 : depth[i] + NOISE_M * depth[i] ** 2 * normal;
  }
  return { depth, ...size, mask, camera };
}

/** The depth of the empty table. */
function table(cameraToWorld) {
  const depth = new Float32Array(size.width * size.height);
  const [right, down, forward, height] = [2, 6, 10, 14].map((i) => cameraToWorld[i]);
  for (let i = 0; i < depth.length; i++) {
    const [u, v] = [i % size.width, Math.floor(i / size.width)];
    const fall = (right * (u - camera.cx)) / camera.fx + (down * (v - camera.cy)) / camera.fy + forward;
    const z = -height / fall;
    if (z > 0 && z < FARTHEST_M) depth[i] = z;
  }
  return depth;
}

/** Draws triangles before what is there, and writes `label` into the mask where they are seen. */
function draw(depth, mask, points, indices, label) {
  const corner = (index) => {
    const [x, y, z] = points.subarray(3 * index, 3 * index + 3);
    return [(camera.fx * x) / z + camera.cx, (camera.fy * y) / z + camera.cy, 1 / z];
  };
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [corner(indices[t]), corner(indices[t + 1]), corner(indices[t + 2])];
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area === 0) continue;
    const range = (axis, last) => [
      Math.max(0, Math.ceil(Math.min(a[axis], b[axis], c[axis]))),
      Math.min(last, Math.floor(Math.max(a[axis], b[axis], c[axis]))),
    ];
    const [[left, right], [top, bottom]] = [range(0, size.width - 1), range(1, size.height - 1)];
    for (let v = top; v <= bottom; v++) {
      for (let u = left; u <= right; u++) {
        const p = ((b[0] - u) * (c[1] - v) - (b[1] - v) * (c[0] - u)) / area;
        const q = ((c[0] - u) * (a[1] - v) - (c[1] - v) * (a[0] - u)) / area;
        if (p < 0 || q < 0 || p + q > 1) continue;
        const z = 1 / (p * a[2] + q * b[2] + (1 - p - q) * c[2]);
        const i = v * size.width + u;
        if (depth[i] > 0 && depth[i] <= z) continue;
        depth[i] = z;
        mask[i] = label;
      }
    }
  }
}

/** Random numbers from 0 to 1, the same for the same seed (a linear congruential generator). */
function generator(seed) {
  let state = (seed * 2654435761) % 4294967296;
  return () => {
    state = (state * 1664525 + 1013904223) % 4294967296;
    return state / 4294967296;
  };
}
