/** `npm run cases`: see `cases/datasets.mjs`. */
import { command, count } from "./bench/command.mjs";
import { cases } from "./cases/datasets.mjs";
import { defaultHost } from "./cases/listing.mjs";

/** @param {string} text */
function fraction(text) {
  const number = Number(text);
  if (number >= 0 && number <= 1 && text.trim() !== "") return number;
  throw Object.assign(new Error("Expected a number from 0 to 1."), { code: "commander.invalidArgument" });
}

await command("cases", (program) =>
  program
    .description("Makes case folders of a public dataset in the layout of BOP, which is fetched or given as a folder.")
    .argument("<dataset>", "hb, hope, icbin, lmo, tless, tudl or ycbv; with --from, any name")
    .option("--accept", "fetch it; without this, the command only shows the licence, the archives and their sizes")
    .option("--from <dir>", "the unpacked dataset, instead of fetching it")
    .option("--split <name>", "the folder of the split, such as test; by default the one that is fetched")
    .option("--images <n>", "images of each scene", count, 3)
    .option("--visible <x>", "least visible fraction of an object", fraction, 0.3)
    .option("--scenes", "scene folders, one an image, instead of case folders, one an object")
    .option("--out <dir>", "where everything goes; target/cases by default")
    .option("--host <url>", "a host with the same interface", defaultHost)
    .action((name, options) => cases(name, options)),
);
