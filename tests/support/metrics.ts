/** Comparison of metrics. */
import assert from "node:assert/strict";
import type { Metrics } from "sim3align";

/** The same metrics, but for the rounding of a transform that was written as a matrix and read again. */
export function assertSameMetrics(found: Metrics, expected: Metrics): void {
  assert.deepEqual(Object.keys(found), Object.keys(expected));
  for (const [name, value] of Object.entries(expected) as [keyof Metrics, number | null][]) {
    const other = found[name];
    const isSame =
      value === null || other === null || other === undefined
        ? value === other
        : Math.abs(other - value) <= 1e-9 * Math.abs(value);
    assert.ok(isSame, `${name}: ${other}, not ${value}`);
  }
}
