/** The paper's tables: their rows, their columns in the paper's order and units, and their Markdown. */
import { fixed, markdownTable, mean, median, percent, share } from "./table.mjs";

/** @typedef {import("./results.mjs").ResultRow} ResultRow */
/**
 * @typedef {object} Table
 * @property {string} title
 * @property {readonly string[]} rows names
 */

const ours = {
  precise: "preset=precise",
  "precise, fast": "preset=precise quality=fast",
  "precise, best": "preset=precise quality=best",
  paper: "preset=paper",
};
const icps = ["point-to-plane", "point-to-point"];
/** @type {Record<string, string>} */
const refinement = {
  "no ICP": "preset=paper icp=none",
  ...Object.fromEntries(icps.map((icp) => [`ICP ${icp}, scale locked`, `preset=paper icp=${icp}`])),
  ...Object.fromEntries(icps.map((icp) => [`ICP ${icp}, scale free`, `preset=paper icp=${icp} lockScale=false`])),
};
const voxels = Object.fromEntries(
  [20, 30, 50].map((divisions) => [`voxel = diagonal / ${divisions}`, `preset=paper voxelDivisions=${divisions}`]),
);
/** The guard, the lock of the scale and the hallucination filter: each on and off. */
const guard = Object.fromEntries(
  [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => {
    const [guarded, locked, filtered] = [(bits & 4) === 0, (bits & 2) === 0, (bits & 1) === 0];
    const words = [guarded ? "guard" : "no guard", locked ? "scale locked" : "scale free"];
    words.push(filtered ? "filter" : "no filter");
    const options = [`guard=${guarded ? "0.5,1.5" : "null"}`, "guardMode=clamp", `lockScale=${locked}`];
    options.push(`hallucinationFilter=${filtered}`);
    return [words.join(", "), `preset=paper ${options.join(" ")}`];
  }),
);

/** The rows of our own, as `sim3align-lab bench --row` takes them. */
export const ownRows = Object.entries({ ...ours, ...refinement, ...voxels, ...guard }).map(
  ([name, options]) => `${name}: ${options}`,
);

/**
 * All tables.
 * @param {readonly string[]} imported names of the rows of other programs
 * @returns {Table[]}
 */
export const tables = (imported) => [
  { title: "Main table", rows: [...Object.keys(ours), ...imported] },
  { title: "ICP and scale", rows: Object.keys(refinement) },
  { title: "Voxel size", rows: Object.keys(voxels) },
  { title: "Scale guard", rows: Object.keys(guard) },
];

/**
 * Columns by the name of the metric. Of a share of 1, a pose that shows nothing has none; of a distance it has no number.
 * @type {readonly (readonly [key: string, title: string, digits: number, isShare: boolean])[]}
 */
const columns = [
  ["boundaryF", "boundary F ↑", 3, true],
  ["centerDriftPx", "drift px ↓", 1, false],
  ["iou", "IoU ↑", 3, true],
  ["chamferM", "Chamfer mm ↓", 1, false],
  ["uniChamferM", "UniChamfer mm ↓", 1, false],
  ["fitness", "fitness ↑", 3, true],
  ["normalConsistency", "normals ↑", 3, true],
  ["depthMaeM", "depth MAE mm ↓", 1, false],
];
const head = ["", ...columns.map(([, title]) => title), "strict %", "loose %", "scale %", "rotation °", "transl. %"];
head.push("collapsed %", "clamped %", "s", "n");

/** Means and medians of metrics. @param {readonly (Record<string, number | null> | null | undefined)[]} all */
const metricCells = (all) =>
  columns.map(([key, , digits, isShare]) => {
    // Lengths are in metres; the table has millimetres.
    const factor = key.endsWith("M") ? 1000 : 1;
    const values = all.flatMap((metrics) => metrics?.[key] ?? (isShare ? 0 : [])).map((value) => factor * value);
    return `${fixed(mean(values), digits)} (${fixed(median(values), digits)})`;
  });

/** @param {readonly ResultRow[]} results */
function cells(results) {
  const known = results.filter(({ strict }) => strict !== null);
  const answers = results.filter(({ metrics }) => metrics);
  // No answer is as wrong as can be.
  const error = (/** @type {0 | 1 | 2} */ i) =>
    median(known.map(({ errors }) => errors?.[i] ?? Number.POSITIVE_INFINITY));
  return [
    ...metricCells(results.map(({ metrics }) => metrics)),
    ...[
      percent(share(known.map((one) => one.strict === true))),
      percent(share(known.map((one) => one.loose === true))),
    ],
    ...[percent(error(0)), fixed(error(1), 1), percent(error(2))],
    percent(share(answers.map(({ collapsed }) => collapsed === true))),
    percent(share(answers.map(({ clamped }) => clamped === true))),
    fixed(median(results.flatMap(({ ms }) => ms ?? [])) / 1000, 2),
    answers.length === results.length ? `${results.length}` : `${answers.length} of ${results.length}`,
  ];
}

/**
 * A table as Markdown: every metric as mean (median), and errors. The last row has the metrics of the true poses: no pose can be expected to do better.
 * @param {Table} table
 * @param {readonly ResultRow[]} results
 */
export function tableMarkdown({ rows }, results) {
  const measured = rows.map((name) => ({ name, found: results.filter(({ row }) => row === name) }));
  const own = measured.filter(({ found }) => found.length > 0);
  const truths = own[0]?.found.filter(({ truthMetrics }) => truthMetrics) ?? [];
  const dashes = Array.from({ length: 8 }, () => "–");
  const truth = metricCells(truths.map(({ truthMetrics }) => truthMetrics));
  return markdownTable(head, [
    ...own.map(({ name, found }) => [name, ...cells(found)]),
    ...(truths.length > 0 ? [["(the true pose)", ...truth, ...dashes, `${truths.length}`]] : []),
  ]);
}

export const notes = `Every metric is the mean over the cases, with the median in brackets. A case without an answer, or whose pose shows nothing where
the object is, counts 0 in shares (boundary F, IoU, fitness, normals) and is left out of distances. *strict*: scale within 5 %,
rotation within 10° up to symmetry, translation within 5 % of the diameter; *loose*: twice that. Scale, rotation and
translation are median errors, no answer being as wrong as can be. *collapsed*: s < 0.3 s_init; *clamped*: s stands at a bound
of the guard. *s* is the median CPU time of an answer, for orientation only. *(the true pose)* is the score of the truth itself
against a faulty depth map, mask and mesh.`;
