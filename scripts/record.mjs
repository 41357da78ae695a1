/** `npm run record`: see `record/record.mjs`. */
import { command, count } from "./bench/command.mjs";
import { record } from "./record/record.mjs";

await command("record", (program) =>
  program
    .description("Measures this version on every set, and writes one file of it. An interrupted run is resumed.")
    .option("--quick", "a part of each set")
    .option("--check", "with --quick: fails if anything is worse than in docs/record/quick.json")
    .option("--save", "writes docs/record/: with --quick, what --check compares with, else this version's history")
    .option("--out <dir>", "where results are kept; target/bench/record by default")
    .option("--fresh", "forget what an earlier run has left there")
    .option("--threads <n>", "all by default", count)
    .action(async (options) => {
      const lost = await record(options);
      if (lost.length > 0) throw new Error(`Worse than docs/record/quick.json:\n${lost.join("\n")}`);
    }),
);
