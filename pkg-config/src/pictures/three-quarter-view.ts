/** The three-quarter view: mesh and measured points from beside the camera, where errors along the line of sight show. */
import type { Pinhole } from "../camera/pinhole.js";
import { bounds } from "../conventions/mesh.js";
import { moved, similarityOf } from "../conventions/similarity.js";
import { shaded } from "./layers.js";
import type { Picture } from "./png.js";
import type { Shot } from "./shot.js";
import { View } from "./view.js";

/** Rotation about the vertical and the horizontal axis through the object, radians. */
const TURN = 0.8;
const TILT = 0.35;
/** Colour of what no line of sight has reached. */
const UNSEEN = 246;
/** The share of the picture that the object takes. */
const SHARE = 0.55;

type Point = readonly [x: number, y: number, z: number];

/** Draws the posed mesh and the points of a view in the colours of its picture. */
export async function threeQuarterView(
  shot: Shot,
  view: View,
  pose: readonly number[],
  { data: colours }: Picture,
): Promise<Picture> {
  const { width, height } = view;
  const corners = cornersOf(shot, pose);
  const center = [0, 1, 2].map((k) => corners.reduce((sum, corner) => sum + (corner[k] as number) / 8, 0)) as number[];
  const turn = turnAbout(center as unknown as Point);
  const turned = corners.map((corner) => turn.apply(corner));
  const camera = cameraAround(turned, width, height);

  const mesh = await shot.render(new View(width, height, 1, 0, 0), turn.after(pose), camera);
  const data = new Uint8Array(3 * width * height).fill(UNSEEN);
  const drawn = shaded(mesh, view, camera).data;
  for (let i = 0; i < mesh.length; i++)
    if (mesh[i]) for (let k = 0; k < 3; k++) data[3 * i + k] = drawn[4 * i + k] as number;

  const nearest = mesh.map((z) => z || Number.POSITIVE_INFINITY);
  const { fx, fy, cx, cy } = view.camera(shot.camera);
  const measured = view.sampled(shot.depth, shot.width, shot.height);
  // The columns of the rotation, and its translation.
  const [m0 = 1, m1 = 0, m2 = 0, , m4 = 0, m5 = 1, m6 = 0, , m8 = 0, m9 = 0, m10 = 1, , m12 = 0, m13 = 0, m14 = 0] =
    turn.after([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  for (let i = 0; i < measured.length; i++) {
    const z = measured[i] as number;
    if (z === 0) continue;
    const [x, y] = [(((i % width) - cx) * z) / fx, ((Math.floor(i / width) - cy) * z) / fy];
    const far = m2 * x + m6 * y + m10 * z + m14;
    const u = Math.round(((m0 * x + m4 * y + m8 * z + m12) * camera.fx) / far + camera.cx);
    const v = Math.round(((m1 * x + m5 * y + m9 * z + m13) * camera.fy) / far + camera.cy);
    const at = v * width + u;
    if (far <= 0 || u < 0 || u >= width || v < 0 || v >= height || far >= (nearest[at] as number)) continue;
    nearest[at] = far;
    for (let k = 0; k < 3; k++) data[3 * at + k] = colours[3 * i + k] as number;
  }
  return { data, width, height };
}

/** The corners of the posed mesh's box, camera frame, metres. */
function cornersOf({ mesh, ofArrays }: Shot, pose: readonly number[]): Point[] {
  const { min, max } = bounds(mesh.positions);
  const placed = similarityOf({ matrix: ofArrays(pose) });
  return Array.from({ length: 8 }, (_, corner) => {
    const local = [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? max : min)[axis]) as unknown as Point;
    return moved(placed, [...local]) as unknown as Point;
  });
}

/** The rotation about a point, as a function of points and of column-major matrices. */
function turnAbout(center: Point) {
  const [s, c, a, b] = [Math.sin(TURN), Math.cos(TURN), Math.sin(TILT), Math.cos(TILT)];
  // Turned about y of the camera, which points down, then tilted about x.
  const rows = [
    [c, 0, -s],
    [s * a, b, c * a],
    [s * b, -a, c * b],
  ] as const;
  const rotated = ([x, y, z]: Point) => rows.map((row) => row[0] * x + row[1] * y + row[2] * z) as unknown as Point;
  const apply = (point: Point): Point => {
    const [x, y, z] = rotated([point[0] - center[0], point[1] - center[1], point[2] - center[2]]);
    return [x + center[0], y + center[1], z + center[2]];
  };
  const after = (pose: readonly number[]): number[] => {
    const column = (k: number) => [pose[4 * k], pose[4 * k + 1], pose[4 * k + 2]] as unknown as Point;
    return [0, 1, 2].flatMap((k) => [...rotated(column(k)), 0]).concat([...apply(column(3)), 1]);
  };
  return { apply, after };
}

/** A camera in which the points take a share of the image, about its middle. */
function cameraAround(points: readonly Point[], width: number, height: number): Pinhole {
  const us = points.map(([x, , z]) => x / Math.max(z, 1e-6));
  const vs = points.map(([, y, z]) => y / Math.max(z, 1e-6));
  const [left, right, top, bottom] = [Math.min(...us), Math.max(...us), Math.min(...vs), Math.max(...vs)];
  const focal = SHARE * Math.min(width / (right - left || 1), height / (bottom - top || 1));
  const middle = (low: number, high: number, size: number) => (size - 1) / 2 - (focal * (low + high)) / 2;
  return { fx: focal, fy: focal, cx: middle(left, right, width), cy: middle(top, bottom, height) };
}
