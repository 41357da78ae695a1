/** `npm run bench:peers -- --cases DIR --out DIR`: other libraries' answers, for `sim3align-bench --import`. */
import { command, count } from "./command.mjs";
import { runPeers, testPeers } from "./peers.mjs";

/** @typedef {import("./peers.mjs").PeersRun & { selfTest?: boolean }} Options */

/** @param {Options} options */
async function main({ selfTest, ...options }) {
  if (selfTest) return testPeers(options.python);
  if ((options.cases === undefined) === (options.pairs === undefined)) {
    throw new Error("Found both or neither of --cases and --pairs, expected one. Remedy: name what is to be aligned.");
  }
  if (options.out === undefined) throw new Error("Found no --out. Remedy: name the folder that the answers go to.");
  await runPeers({
    ...options,
    onAnswer: ({ method, case: name, seconds, error }) =>
      console.log(`${method} ${name}: ${error ?? `${seconds?.toFixed(2)} s`}`),
  });
}

/** @param {string} text */
const list = (text) => text.split(",");

await command("bench:peers", (program) =>
  program
    .description(
      "Aligns cases by Open3D's, small_gicp's, KISS-Matcher's and probreg's methods; what the files are for: docs/importing-results.md.",
    )
    .option("--cases <dir...>", "case folders, or folders of case folders")
    .option("--pairs <file>", 'pairs of clouds instead: [{"id", "source", "target", "voxelSizeM"}], .ply or KITTI .bin')
    .option("--out <dir>", "one file per answer, METHOD/NAME.json; those that are there are kept")
    .option("--methods <a,b,…>", "all that apply by default; scripts/bench/peers/methods.py lists them", list)
    .option("--jobs <n>", "processes; times count only of one", count, 1)
    .option("--python <program>", "the Python, 3.11 or 3.12, that the libraries are installed for", "python3")
    .option("--self-test", "only check that every method recovers known motions")
    .action(main),
);
