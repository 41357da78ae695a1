/** The three-quarter view: mesh and measured points from beside the camera, where errors along the line of sight show. */
import type { Pinhole } from "../camera/pinhole.js";
import { bounds } from "../conventions/mesh.js";
import type { Matrix3 } from "../conventions/rotation.js";
import { composed, moved, type Similarity, sim3Of, similarityOf } from "../conventions/similarity.js";
import type { Vector3 } from "../values/validation.js";
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

type Point = Readonly<Vector3>;

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
  const camera = cameraAround(
    corners.map((corner) => moved(turn, corner)),
    width,
    height,
  );

  const turned = sim3Of(composed(turn, similarityOf({ matrix: pose }))).matrix;
  const mesh = await shot.render(new View(width, height, 1, 0, 0), turned, camera);
  const data = new Uint8Array(3 * width * height).fill(UNSEEN);
  const drawn = shaded(mesh, view, camera).data;
  for (let i = 0; i < mesh.length; i++)
    if (mesh[i]) for (let k = 0; k < 3; k++) data[3 * i + k] = drawn[4 * i + k] as number;

  const nearest = mesh.map((z) => z || Number.POSITIVE_INFINITY);
  const { fx, fy, cx, cy } = view.camera(shot.camera);
  const measured = view.sampled(shot.depth, shot.width, shot.height);
  const [xx, xy, xz, yx, yy, yz, zx, zy, zz] = turn.rotation;
  const [tx, ty, tz] = turn.translation;
  for (let i = 0; i < measured.length; i++) {
    const z = measured[i] as number;
    if (z === 0) continue;
    const [x, y] = [(((i % width) - cx) * z) / fx, ((Math.floor(i / width) - cy) * z) / fy];
    const far = zx * x + zy * y + zz * z + tz;
    const u = Math.round(((xx * x + xy * y + xz * z + tx) * camera.fx) / far + camera.cx);
    const v = Math.round(((yx * x + yy * y + yz * z + ty) * camera.fy) / far + camera.cy);
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
    return moved(placed, local);
  });
}

/** The rotation about a point. */
function turnAbout(center: Point): Similarity {
  const [s, c, a, b] = [Math.sin(TURN), Math.cos(TURN), Math.sin(TILT), Math.cos(TILT)];
  // Turned about y of the camera, which points down, then tilted about x.
  const rotation: Matrix3 = [c, 0, -s, s * a, b, c * a, s * b, -a, c * b];
  const [x, y, z] = moved({ scale: 1, rotation, translation: [0, 0, 0] }, center);
  return { scale: 1, rotation, translation: [center[0] - x, center[1] - y, center[2] - z] };
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
