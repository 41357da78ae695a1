/** The picture of the record: how often each confidence is right, and how many poses of each set are. */

const INK = "#1a1f27";
const QUIET = "#545d6b";
const LINE = "#d9dde3";
const ACCENT = "#0a5cb8";

/** The sides of a plot, pixels. */
const SIDE = 260;

/** @param {number} x @param {number} y @param {string} words */
const text = (x, y, words, anchor = "start", colour = QUIET) =>
  `<text x="${x}" y="${y}" text-anchor="${anchor}" fill="${colour}">${words}</text>`;

/** @param {readonly [number, number]} from @param {readonly [number, number]} to */
const line = ([x1, y1], [x2, y2], colour = LINE) =>
  `<line x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}" stroke="${colour}" />`;

/** The share of right poses over their confidence; the area of a dot is the number of poses. @param {readonly string[][]} rows */
function reliability(rows) {
  const at = (/** @type {number} */ percent) => SIDE - (percent * SIDE) / 100;
  const most = Math.max(...rows.map(([, poses]) => Number(poses)));
  const grid = [0, 50, 100].flatMap((percent) => [
    line([0, at(percent)], [SIDE, at(percent)]),
    text(-6, at(percent) + 4, `${percent}`, "end"),
    text(SIDE - at(percent), SIDE + 18, `${percent / 100}`, "middle"),
  ]);
  const dots = rows.map(([range = "", poses, right]) => {
    const middle = 100 * (Number(range.split(" ")[0]) + 0.05);
    const radius = (3 + 9 * Math.sqrt(Number(poses) / most)).toFixed(1);
    return `<circle cx="${SIDE - at(middle)}" cy="${at(Number(right)).toFixed(1)}" r="${radius}" fill="${ACCENT}" />`;
  });
  const title = text(0, -14, "right %, by confidence", "start", INK);
  return [title, ...grid, line([0, SIDE], [SIDE, 0], QUIET), ...dots].join("\n");
}

/** The share of strictly right poses, a line for each set and a dot for each of its rows. @param {readonly string[][]} rows */
function accuracy(rows) {
  const sets = [...new Set(rows.map(([set = ""]) => set))];
  const step = SIDE / sets.length;
  const at = (/** @type {number} */ percent) => (percent * SIDE) / 100;
  const grid = [0, 50, 100].flatMap((percent) => [
    line([at(percent), 0], [at(percent), SIDE]),
    text(at(percent), SIDE + 18, `${percent}`, "middle"),
  ]);
  const lines = sets.flatMap((set, i) => {
    const y = (i + 0.5) * step;
    const of = rows.filter(([name]) => name === set);
    const dots = of.map(
      ([, , , strict]) =>
        `<circle cx="${at(Number(strict)).toFixed(1)}" cy="${y}" r="4" fill="${ACCENT}" fill-opacity="0.6" />`,
    );
    return [text(-8, y + 4, set, "end"), line([0, y], [SIDE, y]), ...dots];
  });
  return [text(0, -14, "strictly right %, by set", "start", INK), ...grid, ...lines].join("\n");
}

/**
 * An SVG.
 * @param {readonly string[][]} sets rows of the table of sets: set, row, cases, strict % …
 * @param {readonly string[][]} confidences rows of the table of confidences: range, poses, right %
 */
export const recordPicture = (
  sets,
  confidences,
) => `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 330" font-family="system-ui, sans-serif" font-size="13">
<title>How often poses are right</title>
<rect width="720" height="330" fill="#ffffff" />
<g transform="translate(50 40)">
${reliability(confidences)}
</g>
<g transform="translate(430 40)">
${accuracy(sets)}
</g>
</svg>
`;
