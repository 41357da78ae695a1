/** Whether the depth in a mask is that of the plane around it, as where a sensor sees through glass. */
import type { CoreInput } from "../modules/core-input.js";
import { type Reading, readingsAround } from "./readings.js";

/** How far around the mask the plane is looked for, in sides of its bounding box. */
const MARGIN = 0.35;
/** Share of the readings around the mask that lie on the plane, and of those in the mask that must. */
const ON_PLANE = { around: 0.6, inside: 0.8 } as const;
/** Distance from the plane, relative to the depth, within which a reading is on it; and in deviations of those around the mask. */
const NEAR = { least: 0.008, most: 0.016, deviations: 4 } as const;
/** Largest mean distance of the readings in the mask towards the camera: flat objects are nearer than what they lie on. */
const RAISED = 0.002;
/** Fits of the plane, each to the readings near the one before. */
const ROUNDS = 8;
/** Readings below which nothing can be said. */
const FEW = 50;

/** A plane: 1/z = a·u + b·v + c. */
type Plane = readonly [a: number, b: number, c: number];

/** Whether the readings in the mask continue a plane around it. */
export function continuesPlane(input: CoreInput): boolean {
  const readings = readingsAround(input, MARGIN);
  const around = readings.filter(({ isMasked }) => !isMasked);
  const inside = readings.filter(({ isMasked }) => isMasked);
  if (Math.min(around.length, inside.length) < FEW) return false;

  let nearest = around;
  let behind = (_: Reading) => 0;
  for (let round = 0; round < ROUNDS; round++) {
    const plane = fitted(nearest);
    if (plane === undefined) return false;
    behind = (reading) => distance(plane, reading);
    const sorted = [...around].sort((a, b) => Math.abs(behind(a)) - Math.abs(behind(b)));
    nearest = sorted.slice(0, Math.ceil(ON_PLANE.around * around.length));
  }
  const typical = Math.abs(behind(nearest[Math.floor(nearest.length / 2)] as Reading));
  const near = Math.max(NEAR.least, NEAR.deviations * typical);
  const share = (side: readonly Reading[]) =>
    side.filter((reading) => Math.abs(behind(reading)) < near).length / side.length;
  const raised = inside.reduce((sum, reading) => sum - clamped(behind(reading), near), 0) / inside.length;
  return near < NEAR.most && share(around) >= ON_PLANE.around && share(inside) >= ON_PLANE.inside && raised < RAISED;
}

const clamped = (x: number, most: number) => Math.min(Math.max(x, -most), most);

/** How far a reading is behind a plane along its ray, relative to its depth. */
const distance = ([a, b, c]: Plane, { u, v, z }: Reading): number => z * (a * u + b * v + c) - 1;

/** The plane with the least squares of the relative distances; `undefined` if the readings are on a line. */
function fitted(readings: readonly Reading[]): Plane | undefined {
  const [m, y] = [new Float64Array(9), new Float64Array(3)];
  for (const { u, v, z } of readings) {
    const row = [z * u, z * v, z];
    row.forEach((x, i) => {
      y[i] = (y[i] as number) + x;
      row.forEach((other, j) => {
        m[3 * i + j] = (m[3 * i + j] as number) + x * other;
      });
    });
  }
  return solved([...m], [...y]);
}

/** Cramer's rule. */
function solved(m: readonly number[], y: readonly number[]): Plane | undefined {
  const det = ([a = 0, b = 0, c = 0, d = 0, e = 0, f = 0, g = 0, h = 0, i = 0]: readonly number[]) =>
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  const whole = det(m);
  const plane = [0, 1, 2].map(
    (column) => det(m.map((x, k) => (k % 3 === column ? (y[Math.floor(k / 3)] ?? 0) : x))) / whole,
  );
  return plane.every(Number.isFinite) ? (plane as unknown as Plane) : undefined;
}
