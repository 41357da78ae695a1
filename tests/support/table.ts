/** Two objects on a table, and a third one in the air, made independently of the package. */
import { exportGlb } from "sim3align/conventions";
import { type Files, npy, png } from "./files.js";
import { blob, type Mesh, type Pinhole, type Pose, poseJson, render } from "./scene.js";

const [width, height] = [160, 120];
const camera: Pinhole = { fx: 170, fy: 170, cx: 79.5, cy: 59.5 };

/** A blob whose underside is cut flat: it stands on z = 0 of its frame. */
function standing(): Mesh {
  const { positions, indices } = blob(28, 40);
  const cut = positions.map((x, i) => (i % 3 === 2 ? Math.max(x, -0.3) + 0.3 : x));
  return { positions: cut, indices };
}

export const standingMesh = standing();

/** The mesh as a GLB. */
export const standingGlb = exportGlb(
  standingMesh,
  { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] },
  { frame: "opencv" },
);

/** The table: n·x + d = 0, n up. */
const [sine, cosine] = [Math.sin(0.7), Math.cos(0.7)];
export const plane = { normal: [0, -cosine, -sine] as const, d: 0.62 };

/** The rotation that turns the mesh's z to the normal, after a turn about z. */
function upright(turn: number): Pose["rotation"] {
  // About x by the angle from z to the normal, then about the mesh's own z.
  const half = 0.5 * Math.atan2(cosine, -sine);
  const [x, w] = [Math.sin(half), Math.cos(half)];
  const [z, c] = [Math.sin(0.5 * turn), Math.cos(0.5 * turn)];
  return [x * c, -x * z, w * z, w * c];
}

/** A pose whose lowest point is `above` metres over the table; `along` is to the right and away, metres. */
function onTable(scale: number, turn: number, [right, away]: [number, number], above: number): Pose {
  // The table's directions in the camera frame, and its point below the camera's axis.
  const up = plane.normal;
  const out = [0, -sine, cosine] as const;
  const middle = plane.d / sine;
  const at = (i: 0 | 1 | 2) => (i === 2 ? middle : 0) + (i === 0 ? right : 0) + away * out[i] + above * up[i];
  return { scale, rotation: upright(turn), translation: [at(0), at(1), at(2)] };
}

export const poses: Pose[] = [
  onTable(0.07, 0.4, [-0.12, 0.02], 0),
  onTable(0.055, 2.1, [0.11, -0.03], 0),
  onTable(0.05, -1.2, [0.02, 0.3], 0.18),
];

const views = poses.map((pose) => render(standingMesh, pose, camera, width, height, 9));
const depth = new Float32Array(width * height);
const owner = new Uint8Array(width * height);
for (let i = 0; i < depth.length; i++) {
  const ray = [((i % width) - camera.cx) / camera.fx, (Math.floor(i / width) - camera.cy) / camera.fy, 1] as const;
  const facing = ray[0] * plane.normal[0] + ray[1] * plane.normal[1] + ray[2] * plane.normal[2];
  const table = -plane.d / facing;
  depth[i] = table > 0 && table < 4 ? table : 0;
  for (const [k, view] of views.entries()) {
    const z = view.depth[i] ?? 0;
    if (view.mask[i] === 0 || (depth[i] !== 0 && z >= (depth[i] ?? 0))) continue;
    [depth[i], owner[i]] = [z, k + 1];
  }
}

/** The label map: the number of the object, from 1. */
export const labels = { data: owner, width, height };

export const masks = poses.map((_, k) => Uint8Array.from(owner, (label) => (label === k + 1 ? 1 : 0)));

export const tableView = { depth, width, height, camera };

/** A scene folder of so many of the objects. */
export function tableFiles(objects = masks.length): Files {
  const files: Files = { "depth.npy": npy(depth, height, width), "camera.json": { ...camera, width, height } };
  for (const [i, mask] of masks.slice(0, objects).entries()) {
    const own = {
      "mask.png": png(mask, width, height),
      "mesh.glb": standingGlb,
      "gt.json": poseJson(poses[i] as Pose),
    };
    for (const [name, content] of Object.entries(own)) files[`objects/thing-${i}/${name}`] = content;
  }
  return files;
}

/** The scene. */
export const tableScene = {
  ...tableView,
  objects: masks.map((mask, i) => ({ name: `object ${i}`, mask, mesh: standingMesh })),
};
