/**
 * `npm run bench:ablation`: what each part of the search is worth. `npm run bench:reliability`: how often poses are right
 * by their confidence. Both over generated cases.
 */
import { command, count } from "./command.mjs";
import { benchmarkRows } from "./records.mjs";
import { ablationTable, alternativesTable, failureTable, reliabilityTable } from "./search-tables.mjs";

const everything = "everything:";
const ablations = [
  everything,
  ...["occlusion", "outline", "normals", "anchors"].map((part) => `no ${part}: search.${part}=0`),
  ...[300, 1000, 3000, 6000].map((rotations) => `${rotations} rotations: search.rotations=${rotations}`),
];

const notes = `Right, or strict: scale within 5 %, rotation within 10° up to symmetry, translation within 5 % of the
diameter; loose: twice that. Errors and seconds are medians (native, all threads at work), IoU is a mean. A wrong pose
that scores below the truth is a failure of the search, another one of the scoring.`;

/** @param {import("./records.mjs").BenchOptions} options */
async function ablation(options) {
  console.log(`\n${ablationTable(await benchmarkRows(options, ablations))}\n\n${notes}`);
}

/** @param {import("./records.mjs").BenchOptions & { row?: string }} options */
async function reliability(options) {
  const rows = await benchmarkRows(options, [everything]);
  const chosen = options.row === undefined ? rows[0] : rows.find(({ row }) => row === options.row);
  if (!chosen) throw new Error(`No such row. There are ${rows.map(({ row }) => row).join(", ")}.`);
  const tables = [reliabilityTable, failureTable, alternativesTable].map((table) => table(chosen.records));
  console.log(`\n${[chosen.row, ...tables, notes].join("\n\n")}`);
}

const name = process.argv[2] === "reliability" ? "reliability" : "ablation";
process.argv.splice(2, 1);
await command(`bench:${name}`, (program) => {
  program
    .option("--cases <n>", "generated cases", count, 240)
    .option("--set <name>", "the generated set: general (default), sensors, colors or dilated")
    .option("--set-seed <s>", "seed of the generated set", Number, 0)
    .option("--meshes <dir>", "show the GLB files of a folder in a third of the cases")
    .option("--threads <n>", "all by default", count)
    .option("--json <file>", "keep everything about every case here", `target/bench/${name}.json`)
    .option("--from <file>", "run nothing, and read what an earlier run has kept");
  if (name === "ablation") {
    return program.description("Leaves out one part of the search at a time, and prints one table.").action(ablation);
  }
  return program
    .description("Compares confidence with success, and counts failures of the search and of its scoring.")
    .option("--row <name>", "which row of the file; the first by default")
    .action(reliability);
});
