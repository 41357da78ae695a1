/** `npm run bench:ablation [-- --cases N --meshes DIR]`: what each part of the search is worth, on generated cases. */
import { ablationTable } from "./ablation-table.mjs";
import { command, setOptions } from "./command.mjs";
import { benchmarkRows } from "./records.mjs";

const rows = [
  "everything:",
  "no occlusion rule: search.occlusion=0",
  "no outline: search.outline=0",
  "no normals: search.normals=0",
  "no anchors: search.anchors=0",
  "scale locked: search.lockScale=1",
  ...[300, 1000, 3000, 6000].map((rotations) => `${rotations} rotations: search.rotations=${rotations}`),
];

await command("bench:ablation", (program) =>
  setOptions(program, "target/bench/ablation.json")
    .description("Leaves out one part of the search at a time, over generated cases, and prints one table.")
    .action(async (options) => {
      console.log(`\n${ablationTable(await benchmarkRows(options, rows))}\n`);
      console.log(
        "Success: scale within 5 %, rotation within 10° up to symmetry, translation within 5 % of the diameter (loose: twice that). Errors and seconds are medians (native, all threads at work), IoU is a mean. A wrong pose that scores below the truth is a failure of the search, another one of the scoring.",
      );
    }),
);
