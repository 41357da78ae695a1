/** The box around a mesh along its own axes, looked at once: wherever the mesh is put, its box goes with it. */
import type { MeshArrays } from "sim3align";
import { applyToPoints, type Sim3, type Vector3 } from "sim3align/conventions";

/** In the mesh's frame and unit. */
export interface Bounds {
  readonly middle: Vector3;
  readonly sides: Vector3;
}

/** A box where it really is: camera frame, metres; its sides are along the mesh's x, y and z. */
export interface PlacedBox {
  readonly centerM: Vector3;
  readonly sizeM: Vector3;
}

/** The bounds of a mesh's triangles. */
export function boundsOf({ positions, indices }: MeshArrays): Bounds {
  const low: Vector3 = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  const high: Vector3 = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY];
  const count = indices?.length ?? positions.length / 3;
  for (let i = 0; i < count; i++) {
    const vertex = 3 * (indices?.[i] ?? i);
    for (const k of [0, 1, 2] as const) {
      const x = positions[vertex + k] ?? 0;
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  }
  const both = (of: (low: number, high: number) => number) => low.map((x, k) => of(x, high[k] ?? x)) as Vector3;
  return { middle: both((a, b) => (a + b) / 2), sides: both((a, b) => b - a) };
}

/** The box of a mesh at a pose. */
export function placed({ middle, sides }: Bounds, pose: Sim3): PlacedBox {
  const [x = 0, y = 0, z = 0] = applyToPoints(pose, Float64Array.from(middle));
  return { centerM: [x, y, z], sizeM: sides.map((side) => pose.scale * side) as Vector3 };
}
