/** Results, as tests compare them. */
import assert from "node:assert/strict";
import type { Sim3 } from "sim3align";
import { rotationRows } from "./scene.js";

/** A result without its times, which differ from run to run. */
export function withoutTimes<T extends { diagnostics: { timingsMs: unknown } }>({ diagnostics, ...result }: T) {
  const { timingsMs: _, ...others } = diagnostics as T["diagnostics"];
  return { ...result, diagnostics: others };
}

/** All that must be the same, of any result. */
export const bits = (result: unknown) =>
  JSON.stringify(result, (key, value) => (key === "timingsMs" ? undefined : value));

/** Intersection over union of two regions: of the same size, outside 0. */
export function maskIou(a: ArrayLike<number>, b: ArrayLike<number>): number {
  let [both, either] = [0, 0];
  for (let i = 0; i < a.length; i++) {
    if (a[i] && b[i]) both++;
    if (a[i] || b[i]) either++;
  }
  return both / either;
}

/** Checks that a transform comes in every promised form, all saying the same. */
export function assertForms({ scale, rotation, rotationMatrix, translation, matrix }: Sim3): void {
  assert.ok(scale > 0);
  assert.equal(rotation.length, 4);
  assert.ok(Math.abs(Math.hypot(...rotation) - 1) < 1e-12);
  assert.ok(rotation[3] >= 0);
  assert.ok(Array.isArray(matrix) && matrix.length === 16);
  const rows = rotationRows(rotation);
  for (const i of [0, 1, 2] as const) {
    for (const j of [0, 1, 2] as const) {
      assert.ok(Math.abs(rows[i][j] - rotationMatrix[i][j]) < 1e-9, "matrix and quaternion are one rotation");
      assert.ok(Math.abs((matrix[4 * j + i] ?? 0) - scale * rotationMatrix[i][j]) < 1e-9, "columns come first");
    }
    assert.equal(matrix[12 + i], translation[i]);
  }
  assert.deepEqual([matrix[3], matrix[7], matrix[11], matrix[15]], [0, 0, 0, 1]);
}
