/** The rows of the paper's tables, and what runs for each of them. */

/**
 * A method and its options: assignments as `sim3align-bench --row` takes them. Rows without assignments are answers
 * that another program gave.
 * @typedef {{ name: string, assignments: string | null }} RowSpec
 */
/**
 * @typedef {object} TableSpec
 * @property {string} id
 * @property {string} title
 * @property {readonly RowSpec[]} rows
 * @property {readonly string[]} priors the kinds of mesh
 * @property {boolean} truth whether the true pose has a row
 */

/** @param {string} name @param {string} assignments @returns {RowSpec} */
const row = (name, assignments) => ({ name, assignments });

/** @type {readonly RowSpec[]} */
const ours = [
  row("precise", "preset=precise"),
  row("precise, fast", "preset=precise quality=fast"),
  row("precise, best", "preset=precise quality=best"),
  row("paper", "preset=paper"),
];

/** @type {readonly RowSpec[]} */
const baselines = [
  row("FGR", "method=fgr"),
  row("GICP", "method=gicp"),
  row("ICP, point-to-plane", "method=icp-point-to-plane"),
  row("ICP, point-to-point", "method=icp-point-to-point"),
  row("RANSAC, rigid", "method=ransac"),
  row("TEASER++", "method=teaser"),
];

/**
 * The guard, the lock of the scale and the hallucination filter: each on and off.
 * @type {readonly RowSpec[]}
 */
const guard = [true, false].flatMap((guarded) =>
  [true, false].flatMap((locked) =>
    [true, false].map((filtered) => {
      const words = [
        guarded ? "guard" : "no guard",
        locked ? "scale locked" : "scale free",
        filtered ? "filter" : "no filter",
      ];
      const options = [`guard=${guarded ? "0.5,1.5" : "null"}`, "guardMode=clamp"];
      options.push(`lockScale=${locked}`, `hallucinationFilter=${filtered}`);
      return row(words.join(", "), `preset=paper ${options.join(" ")}`);
    }),
  ),
);

/** @type {readonly RowSpec[]} */
const refinement = [
  row("no ICP", "preset=paper icp=none"),
  ...["point-to-plane", "point-to-point"].flatMap((icp) => [
    row(`ICP ${icp}, scale locked`, `preset=paper icp=${icp}`),
    row(`ICP ${icp}, scale free`, `preset=paper icp=${icp} lockScale=false`),
  ]),
];

/** @type {readonly RowSpec[]} */
const voxels = [20, 30, 50].map((divisions) =>
  row(`voxel = diagonal / ${divisions}`, `preset=paper voxelDivisions=${divisions}`),
);

/**
 * All tables.
 * @param {readonly string[]} imported names of the rows that other programs gave answers for
 * @param {readonly string[]} priors the kinds of mesh that there are cases of; all but one table are about the first
 * @returns {TableSpec[]}
 */
export function tableSpecs(imported, priors) {
  const others = imported.map((name) => ({ name, assignments: null }));
  const first = priors.slice(0, 1);
  const one = ours.filter(({ name }) => ["precise", "paper"].includes(name));
  const swap = { id: "prior", title: "Mesh prior", rows: [...one, ...baselines], priors, truth: true };
  return [
    { id: "main", title: "Main table", rows: [...ours, ...baselines, ...others], priors: first, truth: true },
    { id: "refinement", title: "ICP and scale", rows: refinement, priors: first, truth: false },
    { id: "voxel", title: "Voxel size", rows: voxels, priors: first, truth: false },
    ...(priors.length > 1 ? [swap] : []),
    { id: "guard", title: "Scale guard", rows: guard, priors: first, truth: false },
  ];
}

/**
 * The rows to run on a prior's cases: each of our own once.
 * @param {readonly TableSpec[]} specs
 * @param {string} prior
 * @returns {{ name: string, assignments: string }[]}
 */
export function rowsToRun(specs, prior) {
  const rows = new Map();
  for (const spec of specs.filter(({ priors }) => priors.includes(prior))) {
    for (const { name, assignments } of spec.rows) if (assignments !== null) rows.set(name, { name, assignments });
  }
  return [...rows.values()];
}
