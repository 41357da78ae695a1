/**
 * `node scripts/release.mjs TAG`: checks that a tag can be released, and prints the notes of the release.
 * With `--distribution-tag`, it prints the tag of npm instead.
 */
import { readFileSync } from "node:fs";
import { parseArgs } from "node:util";
import { print } from "./lib/output.mjs";
import { packageVersion } from "./lib/package.mjs";
import { at } from "./lib/paths.mjs";
import { distributionTag, releaseNotes } from "./lib/release.mjs";
import { script } from "./lib/step.mjs";

await script(async () => {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { "distribution-tag": { type: "boolean" } },
  });
  const [tag = ""] = positionals;
  const version = packageVersion();
  const text = (/** @type {string} */ name) => readFileSync(at(name), "utf8");
  const manifest = JSON.parse(text("pkg-config/package.json"));
  const notes = releaseNotes(tag, manifest, text("CHANGELOG.md"), text("CITATION.cff"));
  print(`${values["distribution-tag"] ? distributionTag(version) : notes}\n`);
});
