/** Whether results of the same cases have become worse, by more than chance makes them differ. */

/**
 * Probability of at least `losses` among so many changes, if gains and losses are equally likely.
 * @param {number} losses
 * @param {number} gains
 */
export function signTest(losses, gains) {
  const all = losses + gains;
  // Logarithms, because the coefficients of many cases overflow.
  let term = -all * Math.LN2;
  let sum = 0;
  for (let k = 0; k <= all; k++) {
    if (k >= losses) sum += Math.exp(term);
    term += Math.log(all - k) - Math.log(k + 1);
  }
  return Math.min(1, sum);
}

/**
 * Probability that differences whose signs were random would have at least this rank sum of the positive ones (Wilcoxon's
 * signed ranks, by the normal approximation, without the cases that did not change).
 * @param {readonly number[]} differences
 */
export function signedRankTest(differences) {
  const changed = differences.filter((d) => d !== 0).sort((a, b) => Math.abs(a) - Math.abs(b));
  const n = changed.length;
  if (n === 0) return 1;
  let positive = 0;
  let variance = 0;
  for (let i = 0; i < n; ) {
    let end = i;
    while (end < n && Math.abs(changed[end] ?? 0) === Math.abs(changed[i] ?? 0)) end++;
    // Equal differences share the mean of their ranks.
    const rank = (i + 1 + end) / 2;
    for (; i < end; i++) {
      positive += (changed[i] ?? 0) > 0 ? rank : 0;
      variance += rank * rank;
    }
  }
  const z = (positive - (n * (n + 1)) / 4 - 0.5) / Math.sqrt(variance / 4);
  return normalTail(z);
}

/** Probability above z of the normal distribution (Abramowitz and Stegun, 26.2.17; error below 1e-7). @param {number} z @returns {number} */
function normalTail(z) {
  if (z < 0) return 1 - normalTail(-z);
  const t = 1 / (1 + 0.2316419 * z);
  const poly = [0.31938153, -0.356563782, 1.781477937, -1.821255978, 1.330274429].reduceRight((s, c) => (s + c) * t, 0);
  return (poly * Math.exp((-z * z) / 2)) / Math.sqrt(2 * Math.PI);
}
