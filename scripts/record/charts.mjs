/** Charts of confidences, as SVG that takes its colours from the page. */

/** @typedef {readonly (readonly [n: number, right: number])[]} Bins of the confidence, from 0 to 1 */

const SIDE = 200;
const LEFT = 40;
const TOP = 14;
const BOTTOM = 34;

const x = (/** @type {number} */ share) => LEFT + share * SIDE;
const y = (/** @type {number} */ share) => TOP + (1 - share) * SIDE;
const at = (/** @type {number} */ across, /** @type {number} */ up) => `${x(across).toFixed(1)},${y(up).toFixed(1)}`;

/**
 * The share that is right of each tenth of the confidence, with a bar for what the number of poses leaves open (the
 * standard deviation of a share).
 * @param {Bins} bins
 */
export function reliabilityChart(bins) {
  const marks = bins.map(([n, right], i) => {
    if (n === 0) return "";
    const [middle, share] = [(i + 0.5) / bins.length, right / n];
    // Of one more right and one more wrong pose, so that few poses are never sure.
    const deviation = Math.sqrt(((right + 1) * (n - right + 1)) / ((n + 2) ** 2 * (n + 3)));
    const [low, high] = [Math.max(0, share - deviation), Math.min(1, share + deviation)];
    return `<path d="M${at(middle, low)}L${at(middle, high)}" stroke="var(--mark)"/>
<circle cx="${x(middle)}" cy="${y(share).toFixed(1)}" r="4" fill="var(--mark)"><title>${right} of ${n} right</title></circle>
<text x="${x(middle)}" y="${y(0) - 4}" text-anchor="middle" font-size="9">${n}</text>`;
  });
  return chart("confidence", "right", `<path d="M${at(0, 0)}L${at(1, 1)}" stroke="var(--line)"/>${marks.join("")}`);
}

/**
 * How many poses are left if those below a confidence are left out, and the share of them that is right.
 * @param {Bins} bins
 */
export function coverageChart(bins) {
  const all = bins.reduce((sum, [n]) => sum + n, 0);
  let [left, right] = [0, 0];
  const points = [...bins].reverse().flatMap(([n, good]) => {
    left += n;
    right += good;
    return n === 0 ? [] : [[left / all, right / left]];
  });
  const line = points.map(([across = 0, up = 0]) => at(across, up)).join("L");
  const dots = points.map(
    ([across = 0, up = 0]) =>
      `<circle cx="${x(across).toFixed(1)}" cy="${y(up).toFixed(1)}" r="3" fill="var(--mark)"><title>${(100 * up).toFixed(1)} % of ${(100 * across).toFixed(0)} %</title></circle>`,
  );
  return chart("kept", "right", `<path d="M${line}" stroke="var(--mark)" fill="none"/>${dots.join("")}`);
}

/** @param {string} across @param {string} up @param {string} content */
function chart(across, up, content) {
  const ticks = [0, 0.5, 1].map(
    (share) =>
      `<text x="${x(share)}" y="${y(0) + 14}" text-anchor="middle" font-size="10">${share}</text>
<text x="${LEFT - 6}" y="${y(share) + 3}" text-anchor="end" font-size="10">${share}</text>`,
  );
  return `<svg viewBox="0 0 ${LEFT + SIDE + 16} ${TOP + SIDE + BOTTOM}" role="img" aria-label="${up} by ${across}" fill="currentColor">
<rect x="${LEFT}" y="${TOP}" width="${SIDE}" height="${SIDE}" fill="none" stroke="var(--line)"/>${ticks.join("")}
<text x="${x(0.5)}" y="${y(0) + 28}" text-anchor="middle" font-size="11">${across}</text>
<text x="10" y="${y(0.5)}" text-anchor="middle" font-size="11" transform="rotate(-90 10 ${y(0.5)})">${up}</text>${content}</svg>`;
}
