/** `npm run bench:reliability [-- --from FILE]`: whether poses are right as often as their confidence says. */
import { command, setOptions } from "./command.mjs";
import { benchmarkRows } from "./records.mjs";
import { failureTable, reliabilityTable } from "./reliability-table.mjs";

await command("bench:reliability", (program) =>
  setOptions(program, "target/bench/reliability.json")
    .description("Holds confidence against success over generated cases, and tells whose fault wrong poses are.")
    .option("--row <name>", "which row of the file; the first by default")
    .action(async (options) => {
      const rows = await benchmarkRows(options, ["everything:"]);
      const chosen = options.row === undefined ? rows[0] : rows.find(({ row }) => row === options.row);
      if (!chosen) throw new Error(`No such row. There are ${rows.map(({ row }) => row).join(", ")}.`);
      console.log(`\n${chosen.row}\n\n${reliabilityTable(chosen.records)}\n\n${failureTable(chosen.records)}\n`);
      console.log(
        "Right: scale within 5 %, rotation within 10° up to symmetry, translation within 5 % of the diameter. The share of a tier is of that tier. A wrong pose that scores below the truth is a failure of the search, another one of the scoring.",
      );
    }),
);
