/** `npm run record`: see `record/record.mjs` and `record/doubts.mjs`. */
import { command, count } from "./bench/command.mjs";
import { falseAlarms } from "./record/doubts.mjs";
import { record } from "./record/record.mjs";

await command("record", (program) =>
  program
    .description("Measures this version on every set, and writes one file of it. An interrupted run is resumed.")
    .argument("[folder...]", "with --doubts: folders of clean cases and scenes")
    .option("--quick", "a part of each set")
    .option("--check", "with --quick: fails if anything is worse than in docs/record/quick.json")
    .option("--save", "writes docs/record/: with --quick, what --check compares with, else this version's history")
    .option("--out <dir>", "where results are kept; target/bench/record by default")
    .option("--only <a,b,…>", "some of its sets; without --save and --check", (text) => text.split(","))
    .option("--fresh", "forget what an earlier run has left there")
    .option("--threads <n>", "all by default", count)
    .option(
      "--doubts",
      "instead: false alarms of the warnings that doubt an input, in 500 generated cases (10 with --quick)",
    )
    .action(async (folders, options) => {
      if (options.doubts) {
        const often = await falseAlarms(folders, options.quick ? 10 : 500);
        if (often.length > 0) throw new Error(`More than 1 % of clean inputs are doubted by ${often.join(", ")}.`);
        return;
      }
      const lost = await record(options);
      if (lost.length > 0) throw new Error(`Worse than docs/record/quick.json:\n${lost.join("\n")}`);
    }),
);
