/** The sets of a record: the command of the lab that runs each. */
import { readResults } from "../bench/results.mjs";
import { runLab } from "../lib/lab.mjs";

/** @typedef {import("../bench/results.mjs").ResultRow} ResultRow */
/**
 * @typedef {object} RecordSet
 * @property {string} name
 * @property {string} title
 * @property {readonly [full: number, quick: number]} cases 0: the set is not a part of that record
 * @property {(count: number) => readonly string[]} args of `sim3align-lab`
 * @property {(folder: string) => Promise<readonly string[]>} [prepare] makes inputs in a folder; returns the arguments that
 * read them
 * @property {(file: string) => ResultRow[]} [read]
 */

/** A seed with which nothing was set. */
const SEED = ["--seed", "7"];

/**
 * @param {string} name
 * @param {string} title
 * @param {[full: number, quick: number]} cases
 * @returns {RecordSet}
 */
const generated = (name, title, cases) => ({
  name,
  title,
  cases,
  args: (count) => ["bench", "--set", name, "--count", `${count}`, ...SEED],
});

const ROOMS = 6;

/** @type {readonly RecordSet[]} */
export const sets = [
  generated("general", "One object, generated", [480, 72]),
  generated("sensors", "Depth sensors and sources of masks, generated", [264, 33]),
  generated("colors", "Coloured objects with photos, generated", [168, 12]),
  generated("surplus", "Meshes with surplus parts, generated", [96, 12]),
  generated("scenes", "Objects of cluttered scenes, generated", [60, 6]),
  generated("arranged", "Objects that lean, hang and stand on each other, generated", [24, 2]),
  generated("views", "Several views, generated", [24, 3]),
  generated("videos", "Videos, generated", [12, 1]),
  generated("placements", "Placements of generators, simulated", [24, 2]),
  generated("monocular", "Depth as models guess it, generated", [48, 2]),
  {
    name: "registration",
    title: "Pairs of clouds of rooms, generated: register; success is that of 3DMatch",
    cases: [ROOMS, 0],
    args: () => ["registration", "run"],
    async prepare(folder) {
      await runLab(["registration", "write", "rooms", folder, ...SEED, "--scenes", `${ROOMS}`]);
      return ["--data", folder];
    },
    read: registrationResults,
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

/** The results of a set. @param {RecordSet} set @param {string} file */
export const resultsOf = ({ read = readResults }, file) => read(file);

/** Pairs of clouds, by how much they overlap. @param {string} file @returns {ResultRow[]} */
function registrationResults(file) {
  return readResults(file).map((/** @type {any} */ { id, overlap, success, scale, rotationDeg, seconds }) => ({
    row: `overlap ${overlap >= 0.6 ? "≥ 60" : overlap >= 0.3 ? "30–60" : "10–30"} %`,
    name: id,
    strict: success,
    loose: success,
    errors: rotationDeg === null ? null : [scale, rotationDeg, null],
    ms: seconds === null ? null : 1000 * seconds,
  }));
}
