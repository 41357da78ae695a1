/** The sets of a record: the command of the lab that runs each, and how its cases are read. */
import { readFileSync } from "node:fs";
import { isWithin, loose, strict } from "../bench/records.mjs";
import { peerInputs, roomInputs } from "./inputs.mjs";

/**
 * What came of a case: `CaseLine` in `lab/src/bench/case_line.rs`, and what only some commands say.
 * @typedef {object} Line
 * @property {string} row
 * @property {string} case unique in its row
 * @property {boolean} strict
 * @property {boolean} loose
 * @property {readonly [scale: number, rotationDeg: number, translation: number | null] | null} errors
 * @property {number | null} confidence
 * @property {number | null} ms
 * @property {number | null} [work] renders of the search
 * @property {number | null} [iou] of the mask
 * @property {number | null} [truthIou] that of the true pose
 * @property {string} [doubt] why the confidence is low
 */

/**
 * @typedef {object} RecordSet
 * @property {string} name
 * @property {string} title
 * @property {readonly string[]} args of `sim3align-lab`, before the number of cases
 * @property {readonly [full: number, quick: number]} cases; none: the set is not a part of that record
 * @property {readonly string[]} [more] arguments behind the number
 * @property {(json: any) => Line[]} read
 * @property {string} [note] what its rows mean, where that is not what it says above all tables
 * @property {(folder: string) => Promise<readonly string[] | string>} [prepare] makes inputs in a folder; returns the arguments that
 * read them, or why there are none
 * @property {string} [commands] those that make the inputs and read them, for people
 */

/** @param {import("../bench/records.mjs").PoseErrors | null | undefined} errors @returns {Line["errors"]} */
const three = (errors) =>
  errors ? [errors.scaleError, errors.rotationErrorDeg, errors.translationErrorRelative] : null;

/** @param {import("../bench/records.mjs").PoseErrors | null | undefined} errors */
const judged = (errors) => ({
  strict: isWithin(errors, strict),
  loose: isWithin(errors, loose),
  errors: three(errors),
});

/** @param {any} alignment */
function doubtOf({ turnConfidence, alternatives = [], uncertainty, warnings = [] }) {
  if (warnings.length > 0) return `warning ${warnings[0].code}`;
  if (turnConfidence !== null && turnConfidence < 0.5) return "a turn that the evidence hardly decides";
  if (alternatives.length > 0) return "another pose explains the image almost as well";
  if (uncertainty === null) return "an uncertainty that cannot be told";
  return "a low score";
}

/** @param {{ rows: readonly import("../bench/records.mjs").BenchRow[] }} json of `bench` @returns {Line[]} */
const benchLines = ({ rows }) =>
  rows.flatMap(({ row, records }) =>
    records
      .filter(({ truthMetrics }) => truthMetrics !== null)
      .map(({ name, alignment, errors, seconds, truthMetrics }) => ({
        row: row === "precise" ? "align" : row,
        case: name,
        ...judged(errors),
        confidence: alignment?.confidence ?? null,
        ms: 1000 * seconds,
        work: /** @type {any} */ (alignment)?.diagnostics.counts?.renders ?? null,
        iou: alignment?.metrics.iou ?? null,
        truthIou: truthMetrics?.iou ?? null,
        ...(alignment?.confidence === undefined || alignment.confidence >= 0.5 ? {} : { doubt: doubtOf(alignment) }),
      })),
  );

/** @param {any[]} scenes of `together` @returns {Line[]} */
const sceneLines = (scenes) =>
  scenes.flatMap(({ name, objects }) =>
    ["alone", "together"].flatMap((row) =>
      objects.map((/** @type {any} */ object) => ({
        row,
        case: `${name}/${object.name}`,
        ...judged(object[row].errors),
        confidence: object[row].confidence,
        ms: null,
      })),
    ),
  );

/** @param {{ records: any[] }} json of `monocular` @returns {Line[]} */
const monocularLines = ({ records }) =>
  records
    .filter(({ hasTruth, way }) => hasTruth && way === "alone")
    .map(({ row, picture, object, confidence, errors, strict, loose }) => ({
      row,
      case: `${picture}/${object}`,
      strict,
      loose,
      errors: errors && [Math.abs(errors.apparentSize), errors.rotationDeg, errors.direction],
      confidence,
      ms: null,
    }));

/** Pairs of clouds, by how much they overlap. @param {any[]} records of `registration` @returns {Line[]} */
const registrationLines = (records) =>
  records.map(({ id, overlap, success, scale, rotationDeg, seconds }) => ({
    row: `overlap ${overlap >= 0.6 ? "≥ 60" : overlap >= 0.3 ? "30–60" : "10–30"} %`,
    case: id,
    strict: success,
    loose: success,
    errors: rotationDeg === null ? null : [scale, rotationDeg, null],
    confidence: null,
    ms: seconds === null ? null : 1000 * seconds,
  }));

/** @param {Line[]} lines of the other commands */
const ownLines = (lines) => lines;

/** Seeds other than those with which anything was set. */
const seed = ["--set-seed", "7"];

/** Cases for other libraries, of which one takes seconds. */
const PEER_CASES = 60;
const peerCases = ["bench", "--generated", `${PEER_CASES}`, ...seed];
const ROOMS = 6;
const roomOptions = ["--seed", "7", "--scenes", `${ROOMS}`];

/** @type {readonly RecordSet[]} */
export const sets = [
  {
    name: "general",
    title: "One object, generated",
    args: ["bench", "--generated"],
    cases: [480, 108],
    more: seed,
    read: benchLines,
  },
  {
    name: "sensors",
    title: "Depth sensors and predicted masks, generated",
    args: ["bench", "--set", "sensors", "--generated"],
    cases: [240, 60],
    more: seed,
    read: benchLines,
  },
  {
    name: "colors",
    title: "Coloured objects with photos, generated",
    args: ["bench", "--set", "colors", "--generated"],
    cases: [160, 10],
    more: seed,
    read: benchLines,
  },
  {
    name: "scenes",
    title: "Objects of cluttered scenes, generated",
    args: ["together", "--scenes"],
    cases: [60, 8],
    more: seed,
    read: sceneLines,
  },
  {
    name: "views",
    title: "Several views, generated",
    args: ["views", "--seed", "7", "--generated"],
    cases: [24, 3],
    read: ownLines,
  },
  {
    name: "videos",
    title: "Videos, generated",
    args: ["track", "--seed", "7", "--frames", "60", "--generated"],
    cases: [12, 2],
    read: ownLines,
  },
  {
    name: "generators",
    title: "Placements of generators, simulated",
    args: ["generators", "--scenes"],
    cases: [24, 1],
    more: seed,
    read: ownLines,
  },
  {
    name: "monocular",
    title: "Depth as models guess it, generated",
    args: ["monocular", "--ways", "alone", "--generated"],
    cases: [48, 2],
    more: seed,
    read: monocularLines,
  },
  {
    name: "peers",
    title: "Other libraries, with the preprocessing of the paper, on cases of the first set",
    args: ["bench", "--row", "align: preset=precise"],
    cases: [PEER_CASES, 0],
    prepare: (folder) => peerInputs(folder, peerCases),
    commands: `sim3align-lab ${peerCases.join(" ")} --write cases; npm run bench:peers -- --cases cases --out answers; sim3align-lab bench --cases cases --row "align: preset=precise" --import METHOD=answers/METHOD`,
    read: benchLines,
  },
  {
    name: "registration",
    title: "Pairs of clouds of rooms, generated: register",
    note: "Success is that of 3DMatch: the root mean square of the distances that the pose leaves is within .2 m.",
    args: ["registration", "run"],
    cases: [ROOMS, 0],
    prepare: (folder) => roomInputs(folder, roomOptions),
    commands: `sim3align-lab registration write rooms rooms ${roomOptions.join(" ")}; sim3align-lab registration run --data rooms`,
    read: registrationLines,
  },
];

/**
 * The set of the case folders that the user has.
 * @param {string} folder
 * @returns {RecordSet}
 */
export const givenSet = (folder) => ({
  name: "given",
  title: `Case folders of ${folder}`,
  args: ["bench", "--cases", folder],
  cases: [0, 0],
  read: benchLines,
});

/**
 * The arguments of `sim3align-lab` that run a set, or a part of it.
 * @param {RecordSet} set
 * @param {boolean} quick
 */
export function argsOf({ args, cases, more = [], prepare }, quick) {
  const number = prepare === undefined ? cases[quick ? 1 : 0] : 0;
  return [...args, ...(number > 0 ? [`${number}`] : []), ...more];
}

/** The command that reproduces the rows of a set. @param {RecordSet} set */
export const commandOf = (set) => set.commands ?? `sim3align-lab ${argsOf(set, false).join(" ")}`;

/** Four digits, which are more than any set can tell. @param {number} value */
export const rounded = (value) => Number(value.toPrecision(4));

/**
 * The cases of a set, with four digits of each number.
 * @param {RecordSet} set
 * @param {string} file
 * @returns {Line[]}
 */
export const linesOf = (set, file) =>
  JSON.parse(JSON.stringify(set.read(JSON.parse(readFileSync(file, "utf8")))), (_, value) =>
    typeof value === "number" ? rounded(value) : value,
  );
