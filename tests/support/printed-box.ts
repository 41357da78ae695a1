/** A box whose print alone tells which of its half turns is right, and photos of it. */
import { BoxGeometry } from "three";
import { frameAt, type RigFrame } from "./rig.js";
import { type Mesh, rotationRows } from "./scene.js";

type Color = [number, number, number];

/** Half the sides of the box. */
const half = [0.9, 0.6, 0.35] as const;
const CELLS = 14;

/** The print, 0 to 255: each side has a colour of its own, with a spot in one corner. */
function print(point: readonly number[]): Color {
  const scaled = point.map((x, k) => x / (half[k] as number)) as Color;
  const axis = scaled.reduce((best, x, k) => (Math.abs(x) > Math.abs(scaled[best] as number) ? k : best), 0);
  const [a, b] = [scaled[(axis + 1) % 3] as number, scaled[(axis + 2) % 3] as number];
  const side = 2 * axis + ((scaled[axis] as number) > 0 ? 1 : 0);
  const colors: Color[] = [
    [200, 60, 50],
    [60, 120, 200],
    [80, 170, 80],
    [210, 190, 60],
    [150, 80, 170],
    [230, 140, 60],
  ];
  if (a > 0.1 && b > 0.1) return [30, 30, 40];
  if (a < -0.4 && b > -0.2) return [235, 235, 225];
  return colors[side] as Color;
}

/** The box, with colours per vertex. */
function box(): Mesh & { colors: Uint8Array } {
  const [x, y, z] = half;
  const geometry = new BoxGeometry(2 * x, 2 * y, 2 * z, CELLS, CELLS, CELLS);
  const positions = Float32Array.from(geometry.getAttribute("position").array);
  const indices = Uint32Array.from(geometry.index?.array ?? []);
  const colors = new Uint8Array(positions.length);
  for (let k = 0; k < positions.length; k += 3) colors.set(print(Array.from(positions.subarray(k, k + 3))), k);
  return { positions, indices, colors };
}

/** A frame with its photo. */
export type Photographed = RigFrame & { image: { data: Uint8Array; width: number; height: number } };

/** The box, and what a camera sees of it that is turned about it. */
export function printedBox() {
  const mesh = box();
  return { mesh, frameAt: (degrees: number): Photographed => photographed(frameAt(degrees, mesh)) };
}

/** The photo of a frame: the print where the box is seen, darker than it is, and a grey wall. */
function photographed(seen: RigFrame): Photographed {
  const { depth, mask, width, height, camera } = seen.frame;
  const { scale, rotation, translation } = seen.pose;
  const rows = rotationRows(rotation);
  const data = new Uint8Array(3 * width * height).fill(110);
  for (let i = 0; i < width * height; i++) {
    if (mask[i] === 0) continue;
    const z = depth[i] as number;
    const [u, v] = [i % width, Math.floor(i / width)];
    const point = [((u - camera.cx) / camera.fx) * z, ((v - camera.cy) / camera.fy) * z, z];
    const moved = point.map((x, k) => (x - (translation[k] as number)) / scale);
    const own = [0, 1, 2].map((k) => rows.reduce((sum, row, j) => sum + (row[k] as number) * (moved[j] as number), 0));
    data.set(
      print(own).map((c) => Math.round(0.7 * c + 10)),
      3 * i,
    );
  }
  return { ...seen, image: { data, width, height } };
}
