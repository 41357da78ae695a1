/** General registration: pairs of clouds, generated or given, by `register`, the baselines and other libraries. */
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { at } from "../lib/paths.mjs";
import { run } from "../lib/run.mjs";
import { answersJob } from "./paper/jobs.mjs";
import { pairMethods } from "./peer-methods.mjs";
import { runPeers } from "./peers.mjs";

/** @typedef {import("./paper/jobs.mjs").Job} Job */
/** @typedef {import("./paper/report.mjs").GeneralTable} GeneralTable */
/** @typedef {{ id: string, title: string, data: string, every: number }} Dataset every n-th pair is taken */

/** `register`, and the baselines that need no start near the truth. */
const ours = ["register", "fgr", "ransac", "teaser", "quatro"];
/** What a pair is expected to take by one of them, in seconds. */
const expectedSeconds = 1;

/** @param {readonly string[]} args */
const registration = (args) => run(at("target", "native", "sim3align-lab"), ["registration", ...args]);

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
      answersJob(pairMethods, pairs, (onProgress) =>
        runPeers({ pairs: list, out: answers, methods, python, onProgress }),
      ),
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
