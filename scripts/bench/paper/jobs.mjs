/** The work of the paper's tables: our methods, other libraries, and what they answered. */
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { runPeers } from "../peers.mjs";
import { runBenchmark } from "../records.mjs";
import { rowsToRun } from "./rows.mjs";

/** @typedef {import("../progress.mjs").Progress} Progress */
/** @typedef {import("./rows.mjs").TableSpec} TableSpec */
/**
 * @typedef {object} Job
 * @property {number} work seconds that it is expected to take, all of it
 * @property {(progress: Progress) => Promise<void>} run
 */

/** What one alignment is expected to take, in seconds: enough for the time left. */
const expected = { own: 0.12, imported: 0.05 };

/** @param {string} folder */
const caseCount = (folder) => readdirSync(folder).length;

/** The file of a prior's records. @param {string} out @param {string} prior */
export const recordsFile = (out, prior) => join(out, "records", `${prior}.jsonl`);

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
      await runBenchmark([...args, "--records", file], {
        onLine(line) {
          const { done, row, case: name } = JSON.parse(line);
          if (done !== undefined) progress.skip(done * each);
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
  return answersJob(methods, caseCount(cases), (onProgress) =>
    runPeers({ cases: [cases], out, methods: Object.keys(methods), python, onProgress }),
  );
}

/**
 * Counts answers as they come; those that were there already are not told.
 * @param {Record<string, number>} methods
 * @param {number} cases
 * @param {(onProgress: NonNullable<import("../peers.mjs").PeersRun["onProgress"]>) => Promise<void>} run
 * @returns {Job}
 */
export function answersJob(methods, cases, run) {
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
      progress.skip(work - advanced);
    },
  };
}
