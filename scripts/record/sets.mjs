/** The sets of a record: the command of the lab that runs each. */

/**
 * @typedef {object} RecordSet
 * @property {string} name
 * @property {string} title
 * @property {readonly [full: number, quick: number]} cases 0: the set is not a part of that record
 * @property {(count: number) => readonly string[]} args of `sim3align-lab`
 */

/** A seed with which nothing was set. */
const SEED = ["--seed", "7"];

/**
 * @param {string} name
 * @param {string} title
 * @param {[full: number, quick: number]} cases
 * @param {string} [set]
 * @param {readonly string[]} [rows] those of the set by default
 * @returns {RecordSet}
 */
const generated = (name, title, cases, set = name, rows = []) => ({
  name,
  title,
  cases,
  args: (count) => ["bench", "--set", set, "--count", `${count}`, ...SEED, ...rows.flatMap((row) => ["--row", row])],
});
const models = ["affine", "disparity", "no-camera", "disparity-no-camera"].map((model) => `${model}: model=${model}`);
const surplus = ["floaters", "plate"].map((kind) => `${kind}: surplus=${kind}`);
const views = ["known cameras: call=views views=4", "unknown cameras: call=views views=4 cameras=false"];

/** @type {readonly RecordSet[]} */
export const sets = [
  generated("general", "One object, generated", [480, 72]),
  generated("sensors", "Depth sensors and sources of masks, generated", [264, 33]),
  generated("colors", "Coloured objects with photos, generated", [168, 12]),
  generated("surplus", "Meshes with surplus parts, generated", [48, 4], "general", surplus),
  generated("models", "Depth of depth models, generated", [48, 3], "general", models),
  generated("scenes", "Objects of cluttered scenes, generated", [60, 6]),
  generated("placements", "Scenes with placements of a generator", [24, 2], "scenes", [
    "alone: initial=true",
    "together: call=scene initial=true",
  ]),
  generated("videos", "Videos, generated", [12, 1]),
  generated("views", "Several frames of a video", [12, 1], "videos", views),
  {
    name: "registration",
    title: "Pairs of scans of rooms, generated: register",
    cases: [6, 0],
    args: (rooms) => ["bench", "--rooms", `${rooms}`, ...SEED],
  },
];

/**
 * The set of the user's case folders.
 * @param {string} folder
 * @returns {RecordSet}
 */
export const givenSet = (folder) => ({
  name: "given",
  title: `Case folders of ${folder}`,
  cases: [1, 0],
  args: () => ["bench", "--cases", folder],
});

/** The command that reproduces the rows of a set. @param {RecordSet} set */
export const commandOf = ({ args, cases }) => `sim3align-lab ${args(cases[0]).join(" ")}`;
