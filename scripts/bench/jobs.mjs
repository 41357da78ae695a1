/** The benchmark's work: our methods and other libraries, on cases and on pairs of clouds for general registration. */
import { existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { runLab } from "../lib/lab.mjs";
import { at } from "../lib/paths.mjs";
import { rowsToRun } from "./paper/rows.mjs";
import { pairMethods, runPeers } from "./peers.mjs";
import { recordsFile } from "./results.mjs";

/** @typedef {import("./paper/rows.mjs").TableSpec} TableSpec */
/** @typedef {import("./paper/report.mjs").GeneralTable} GeneralTable */
/**
 * The bar of all work, in seconds as they were expected.
 * @typedef {{ advance: (seconds: number, task?: string) => void }} Progress
 */
/**
 * @typedef {object} Job
 * @property {number} work seconds that it is expected to take, all of it
 * @property {(progress: Progress) => Promise<void>} run
 */

/** Expected seconds of one alignment, for the estimate of the time left. */
const expected = { own: 0.12, imported: 0.05 };

/** @param {string} folder */
const caseCount = (folder) => readdirSync(folder).length;

/**
 * Our own rows over a prior's cases.
 * @param {readonly TableSpec[]} specs
 * @param {string} prior
 * @param {string} cases
 * @param {string} out
 * @param {number} [threads]
 * @returns {Job}
 */
export function ownJob(specs, prior, cases, out, threads) {
  const rows = rowsToRun(specs, prior);
  const args = ["--cases", cases, ...rows.flatMap(({ name, assignments }) => ["--row", `${name}: ${assignments}`])];
  if (threads !== undefined) args.push("--threads", `${threads}`);
  return recordsJob(args, recordsFile(out, prior), rows.length * caseCount(cases), expected.own);
}

/**
 * The answers of other programs, scored as our own are.
 * @param {readonly (readonly string[])[]} answers name and folder
 * @param {string} cases
 * @param {string} prior
 * @param {string} out
 * @returns {Job}
 */
export function importJob(answers, cases, prior, out) {
  const args = ["--cases", cases, ...answers.flatMap(([name, folder]) => ["--import", `${name}=${folder}`])];
  return recordsJob(args, recordsFile(out, prior), answers.length * caseCount(cases), expected.imported);
}

/**
 * @param {readonly string[]} args
 * @param {string} file
 * @param {number} records
 * @param {number} each
 * @returns {Job}
 */
function recordsJob(args, file, records, each) {
  return {
    work: records * each,
    async run(progress) {
      await runLab(["bench", ...args, "--records", file], {
        onLine(line) {
          const { done, row, case: name } = JSON.parse(line);
          if (done !== undefined) progress.advance(done * each);
          else progress.advance(each, `${row}, ${name}`);
        },
      });
    },
  };
}

/**
 * Other libraries over the cases.
 * @param {Record<string, number>} methods what an answer of each is expected to take, in seconds
 * @param {string} cases
 * @param {string} out
 * @param {string} python
 * @returns {Job}
 */
export function peersJob(methods, cases, out, python) {
  return answersJob(methods, caseCount(cases), (onAnswer) =>
    runPeers({ cases: [cases], out, methods: Object.keys(methods), python, onAnswer }),
  );
}

/**
 * Counts answers as they come; those that were there already are not told.
 * @param {Record<string, number>} methods
 * @param {number} cases
 * @param {(onAnswer: NonNullable<import("./peers.mjs").PeersRun["onAnswer"]>) => Promise<void>} run
 * @returns {Job}
 */
function answersJob(methods, cases, run) {
  const work = Object.values(methods).reduce((sum, seconds) => sum + seconds, 0) * cases;
  return {
    work,
    async run(progress) {
      let advanced = 0;
      await run(({ method, case: name }) => {
        const seconds = methods[method] ?? 0;
        advanced += seconds;
        progress.advance(seconds, `${method}, ${name}`);
      });
      progress.advance(work - advanced);
    },
  };
}

/** @typedef {{ id: string, title: string, data: string, every: number }} Dataset every n-th pair is taken */

/** `register`, and the baselines that need no start near the truth. */
const ours = ["register", "fgr", "ransac", "teaser", "quatro"];
/** Expected seconds of one of them on one pair. */
const expectedSeconds = 1;

/** @param {readonly string[]} args */
const registration = (args) => runLab(["registration", ...args]);

/**
 * The pairs of a run: rooms and streets of its seed, and folders of the caller's.
 * @param {{ quick: boolean, setSeed: number, data: readonly string[] }} options
 * @returns {Promise<Dataset[]>}
 */
export async function datasets({ quick, setSeed, data }) {
  const scenes = quick ? 1 : 2;
  const every = quick ? 3 : 1;
  const generated = { rooms: "rooms in 3DMatch's layout", lidar: "streets in KITTI's layout" };
  /** @type {Dataset[]} */
  const made = [];
  for (const [kind, title] of Object.entries(generated)) {
    const folder = at("target", "bench", `${kind}-${scenes}-seed-${setSeed}`);
    const complete = join(folder, "complete");
    if (!existsSync(complete)) {
      await registration(["write", kind, folder, "--seed", `${setSeed}`, "--scenes", `${scenes}`]);
      writeFileSync(complete, "");
    }
    made.push({ id: kind, title: `General registration, generated ${title}`, data: folder, every });
  }
  const given = data.map((path) => ({
    id: basename(path),
    title: `General registration, ${basename(path)}`,
    data: path,
    every: 1,
  }));
  return [...made, ...given.map((set) => ({ ...set, data: resolve(set.data) }))];
}

/** @param {string} out @param {Dataset} set */
const folderOf = (out, { id }) => join(out, "registration", id);

/**
 * @param {Dataset} set
 * @param {string} out
 * @param {string | null} python the Python of the other libraries, or none of them
 * @returns {Promise<Job[]>}
 */
export async function generalJobs(set, out, python) {
  const folder = folderOf(out, set);
  mkdirSync(folder, { recursive: true });
  const list = join(folder, "pairs.json");
  const pairsOf = ["--data", set.data, "--every", `${set.every}`];
  await registration(["run", ...pairsOf, "--pairs-json", list]);
  const pairs = JSON.parse(readFileSync(list, "utf8")).length;
  const answers = join(folder, "answers");
  /** @type {Job[]} */
  const jobs = [];
  if (python !== null) {
    const methods = Object.keys(pairMethods);
    jobs.push(
      answersJob(pairMethods, pairs, (onAnswer) => runPeers({ pairs: list, out: answers, methods, python, onAnswer })),
    );
  }
  const imports =
    python === null ? [] : Object.keys(pairMethods).map((name) => `${name}=import:${join(answers, name)}`);
  const work = ours.length * pairs * expectedSeconds;
  jobs.push({
    work,
    async run(progress) {
      const methods = [...ours, ...imports].flatMap((method) => ["--method", method]);
      const files = ["--records", join(folder, "records.jsonl"), "--json", join(folder, "all.json")];
      const markdown = await registration(["run", ...pairsOf, "--measure-overlap", ...methods, ...files]);
      writeFileSync(join(folder, "table.md"), markdown);
      progress.advance(work, set.title);
    },
  });
  return jobs;
}

/**
 * @param {Dataset} set
 * @param {string} out
 * @returns {GeneralTable}
 */
export function generalTable(set, out) {
  const folder = folderOf(out, set);
  const records = JSON.parse(readFileSync(join(folder, "all.json"), "utf8"));
  // Without times, so that the same seed gives the same file.
  const data = records.map((/** @type {{ seconds: number | null }} */ record) => ({ ...record, seconds: undefined }));
  return { id: set.id, title: set.title, markdown: readFileSync(join(folder, "table.md"), "utf8").trim(), data };
}
