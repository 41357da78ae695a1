/** What a view says of a pose, and of the mask itself. */
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { type Box, boxOf } from "./box.js";
import { renderDepth } from "./rasteriser.js";
import { drawnScene } from "./reduced.js";

/** The scene is in front if it is this much nearer, as a share of the depth. */
const NEARER = 0.02;
/** Depth cameras blur edges: a pixel is compared with those at this distance. */
const ACROSS_EDGE = 3;
/** About as many readings are looked at for statistics. */
const SAMPLES = 4000;

/** A view of one object at a pose. */
export interface Posed extends Pick<Scene, "depthM" | "width" | "height" | "camera"> {
  mask: Uint8Array;
  mesh: ObjectModel["mesh"];
  /** Camera from mesh, 16 numbers, column-major. */
  matrix: ArrayLike<number>;
}

/** All lengths are in the unit of the depth map. */
export interface Evidence {
  /** The share of the drawn mesh behind other parts of the scene, 0 to 1. */
  hidden: number;
  /** The overlap (IoU) of the mask with the rest of the drawn mesh. */
  visibleIou: number;
  /**
   * Whether what hides it stands in front of the visible part as well. Of a mesh that is sunk into a surface, or behind it, the
   * surface is hidden by nothing: it goes on from the mask without a step.
   */
  isBehindSomething: boolean;
  /** The median distance of drawn and measured depth in the mask, as a share of the visible extent. */
  residual: number;
  /** The visible extent: the diagonal of the box around the mask, at the median depth in it. */
  extentM: number;
  /** The median depth in the mask. */
  distanceM: number;
  /** How far the readings in the mask, and those around it, are from one plane through those in the mask; shares of the extent. */
  bulge: number;
  step: number;
}

/** The evidence for the present pose of an object. */
export function evidenceOf(scene: Scene, object: ObjectModel): Evidence {
  const { maskOf, ...view } = drawnScene(scene);
  const { mesh, pose } = object;
  return evidence({ ...view, mask: maskOf(object), mesh, matrix: pose.value.transform.matrix });
}

export function evidence({ depthM, width, height, camera, mask, mesh, matrix }: Posed): Evidence {
  const drawn = renderDepth(mesh, matrix, { width, height, camera });
  const neighbours = [-1, 1, -width, width].map((step) => step * ACROSS_EDGE);
  const residuals: number[] = [];
  let [all, hidden, both, either, edges, steps] = [0, 0, 0, 0, 0, 0];
  drawn.forEach((z, pixel) => {
    const measured = depthM[pixel] ?? 0;
    const isObject = mask[pixel] !== 0;
    if (z > 0) all++;
    if (z > 0 && !isObject && measured > 0 && measured < (1 - NEARER) * z) {
      hidden++;
      for (const step of neighbours) {
        const beside = depthM[pixel + step] ?? 0;
        if (!mask[pixel + step] || !(beside > 0)) continue;
        edges++;
        if (measured < (1 - NEARER) * beside) steps++;
      }
      return;
    }
    if (z > 0 && isObject) {
      both++;
      if (measured > 0) residuals.push(Math.abs(measured - z));
    }
    if (z > 0 || isObject) either++;
  });
  const surface = surfaceOf({ depthM, width, camera, mask });
  return {
    ...{ hidden: hidden / (all || 1), visibleIou: both / (either || 1), isBehindSomething: 2 * steps > edges },
    ...surface,
    residual: quantile(residuals, 0.5) / surface.extentM,
  };
}

/** A pixel with the inverse of its depth, which is linear on a plane. */
type Reading = readonly [x: number, y: number, inverse: number];

/** The surface that a mask shows. The numbers are NaN where nothing was measured. */
function surfaceOf({ depthM, width, camera, mask }: Pick<Posed, "depthM" | "width" | "camera" | "mask">) {
  const { left, top, right, bottom } = boxOf(mask, width) ?? ({ left: 0, top: 0, right: 0, bottom: 0 } satisfies Box);
  const [inside, around]: [Reading[], Reading[]] = [[], []];
  const read = (into: Reading[], pixel: number) => {
    const z = depthM[pixel] ?? 0;
    if (z > 0) into.push([pixel % width, Math.floor(pixel / width), 1 / z]);
  };
  const neighbours = [-1, 1, -width, width];
  for (let y = top; y < bottom; y++) {
    for (let x = left; x < right; x++) {
      const pixel = y * width + x;
      if (mask[pixel] === 0) continue;
      read(inside, pixel);
      for (const step of neighbours) {
        const beyond = pixel + (ACROSS_EDGE + 1) * step;
        // The image ends in a row.
        const isInRow = Math.abs(step) !== 1 || Math.floor(beyond / width) === y;
        if (isInRow && mask[pixel + step] === 0 && mask[beyond] === 0) read(around, beyond);
      }
    }
  }
  const distanceM =
    1 /
    quantile(
      inside.map(([, , inverse]) => inverse),
      0.5,
    );
  const extentM = (Math.hypot(right - left, bottom - top) * distanceM) / camera.fx;
  const [a, b, c] = planeThrough(inside);
  const off = ([x, y, inverse]: Reading) => Math.abs(1 / inverse - 1 / (a + b * x + c * y)) / extentM;
  return {
    ...{ distanceM, extentM },
    bulge: quantile(inside.map(off), 0.9),
    step: quantile(around.map(off), 0.5),
  };
}

/** The plane through readings: inverse = a + b · x + c · y, least squares. */
function planeThrough(readings: readonly Reading[]): readonly [number, number, number] {
  const rows = [0, 1, 2].map(() => [0, 0, 0, 0]);
  for (const [x, y, inverse] of readings) {
    const terms = [1, x, y, inverse];
    rows.forEach((row, r) => {
      for (let k = 0; k < 4; k++) row[k] = (row[k] as number) + (terms[r] as number) * (terms[k] as number);
    });
  }
  const at = (r: number, k: number) => rows[r]?.[k] as number;
  for (let k = 0; k < 3; k++) {
    for (let r = 0; r < 3; r++) {
      if (r === k) continue;
      const factor = at(r, k) / at(k, k);
      rows[r] = (rows[r] as number[]).map((value, i) => value - factor * at(k, i));
    }
  }
  return [at(0, 3) / at(0, 0), at(1, 3) / at(1, 1), at(2, 3) / at(2, 2)];
}

/** The value below which this share of values is; NaN of none. */
function quantile(values: readonly number[], share: number): number {
  const stride = Math.ceil(values.length / SAMPLES);
  const some = Float64Array.from(values.filter((_, i) => i % stride === 0)).sort();
  return some[Math.floor(share * (some.length - 1))] ?? Number.NaN;
}
