/** Lines of one colour in the OpenCV camera frame: the frustum of a depth camera, and the ground. */
import type { Color, LineBasicMaterialParameters } from "three/webgpu";
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Vector3 } from "./three.js";
import type { PlaneInput, SceneInput } from "./types.js";

export type Lines = LineSegments<BufferGeometry, LineBasicMaterial>;

/** Points as a geometry. */
export const geometryOf = (positions: readonly number[]): BufferGeometry =>
  new BufferGeometry().setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));

/** Lines between pairs of points, x, y and z in turn. */
export const linesOf = (positions: readonly number[], look: LineBasicMaterialParameters): Lines =>
  new LineSegments(geometryOf(positions), new LineBasicMaterial(look));

/** A pyramid from the camera centre to the image corners at a depth. */
export function frustumOf(scene: SceneInput, depthM: number, color: Color): Lines {
  const { width, height } = scene;
  const corners = imageCorners(scene, depthM);
  const lines = corners.flatMap((point, i) => [0, 0, 0, ...point, ...point, ...(corners[(i + 1) % 4] ?? point)]);
  // A triangle above the image marks the up direction.
  const apex = pointAt(scene, width / 2 - 0.5, -0.5 - 0.22 * height, depthM);
  return linesOf([...lines, ...(corners[0] ?? apex), ...apex, ...apex, ...(corners[1] ?? apex)], { color });
}

/** The corners of the image at a depth, clockwise from the upper left one. */
export function imageCorners(scene: SceneInput, depthM: number): number[][] {
  const [right, bottom] = [scene.width - 0.5, scene.height - 0.5];
  const corners = [
    [-0.5, -0.5],
    [right, -0.5],
    [right, bottom],
    [-0.5, bottom],
  ] as const;
  return corners.map(([u, v]) => pointAt(scene, u, v, depthM));
}

const pointAt = ({ camera }: SceneInput, u: number, v: number, depthM: number) => [
  ((u - camera.cx) / camera.fx) * depthM,
  ((v - camera.cy) / camera.fy) * depthM,
  depthM,
];

/** Lines of the ground in each direction, at least. */
const FLOOR_LINES = 10;

/** A grid around what stands on a plane. */
export function floorOf(
  { normal, d }: PlaneInput,
  centre: readonly [number, number, number],
  radiusM: number,
  color: Color,
): Lines {
  const up = new Vector3(...normal).normalize();
  const foot = new Vector3(...centre);
  foot.addScaledVector(up, -(up.dot(foot) + d));
  // Along the image's x axis, as far as the plane allows.
  const along = new Vector3(1, 0, 0).addScaledVector(up, -up.x).normalize();
  const across = new Vector3().crossVectors(up, along);
  const spacingM = roundStep((4 * radiusM) / FLOOR_LINES);
  const half = spacingM * Math.ceil((2 * radiusM) / spacingM);
  const at = (a: number, b: number) => foot.clone().addScaledVector(along, a).addScaledVector(across, b).toArray();
  const positions: number[] = [];
  for (let x = -half; x <= half + 1e-9; x += spacingM) {
    positions.push(...at(x, -half), ...at(x, half), ...at(-half, x), ...at(half, x));
  }
  return linesOf(positions, { color, transparent: true, opacity: 0.55, depthWrite: false });
}

/** The largest of 1, 2 and 5 times a power of ten that is not above a length. */
function roundStep(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * (length >= 5 * power ? 5 : length >= 2 * power ? 2 : 1);
}
