/** Sums over measurements. */

/**
 * The middle value, or the mean of the two middle ones; NaN of nothing.
 * @param {Iterable<number>} values
 */
export function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  const [low, high] = [sorted[middle - 1] ?? Number.NaN, sorted[middle] ?? Number.NaN];
  if (sorted.length % 2 === 1) return high;
  return low === high ? high : (low + high) / 2;
}

/**
 * The mean; NaN of nothing.
 * @param {readonly number[]} values
 */
export const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/**
 * The share of `true`; NaN of nothing.
 * @param {readonly boolean[]} values
 */
export const share = (values) => values.filter(Boolean).length / values.length;
