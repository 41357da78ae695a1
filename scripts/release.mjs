/**
 * `node scripts/release.mjs TAG`: checks that a tag can be released, and prints the notes of the release: the tag names the version,
 * the changelog has a dated section of it, the citation both, and addresses name the repository.
 * With `--distribution-tag`, it prints the tag of npm instead.
 */
import { readFileSync } from "node:fs";
import { parseArgs } from "node:util";
import { print } from "./lib/output.mjs";
import { packageVersion } from "./lib/package.mjs";
import { at } from "./lib/paths.mjs";
import { script } from "./lib/step.mjs";

/** Placeholder for the owner of the repository in addresses. */
const PLACEHOLDER = "OWNER";

const text = (/** @type {string} */ name) => readFileSync(at(name), "utf8");

/** The section of a version in the changelog: its heading, and what follows. @param {string} version */
function sectionOf(version) {
  const sections = text("CHANGELOG.md").split(/^(?=## \[)/m);
  const [heading = "", ...lines] = sections.find((one) => one.startsWith(`## [${version}]`))?.split("\n") ?? [];
  return { heading, content: lines.join("\n").trim() };
}

/** The notes of a release. @param {string} tag such as v1.0.0 @param {string} version @throws with all that is missing */
function releaseNotes(tag, version) {
  const manifest = JSON.parse(text("pkg-config/package.json"));
  /** @type {string[]} */
  const missing = [];
  if (tag !== `v${version}`)
    missing.push(
      `The tag is ${tag}, the package has version ${version}. Remedy: tag v${version}, or raise the version.`,
    );
  const { heading, content } = sectionOf(version);
  if (content === "")
    missing.push(`CHANGELOG.md says nothing of ${version}. Remedy: write the section ## [${version}].`);
  if (sectionOf("Unreleased").content !== "")
    missing.push(`CHANGELOG.md has unreleased changes. Remedy: move them to the section ## [${version}].`);
  const date = /^## .* - (\d{4}-\d\d-\d\d)$/.exec(heading)?.[1];
  if (!date) missing.push(`CHANGELOG.md has no date of ${version}. Remedy: write ## [${version}] - YYYY-MM-DD.`);
  for (const line of [`version: ${version}`, ...(date ? [`date-released: ${date}`] : [])]) {
    if (!text("CITATION.cff").split(/\r?\n/).includes(line))
      missing.push(`CITATION.cff does not say "${line}". Remedy: write it there.`);
  }
  for (const name of ["repository", "homepage", "bugs"]) {
    const address = JSON.stringify(manifest[name]) ?? "nothing";
    if (!address.includes("https://") || address.includes(PLACEHOLDER))
      missing.push(`${name} of pkg-config/package.json is ${address}. Remedy: write the address of the repository.`);
  }
  if (missing.length > 0) throw new Error(missing.join("\n"));
  return content;
}

await script(async () => {
  const options = /** @type {const} */ ({ "distribution-tag": { type: "boolean" } });
  const { values, positionals } = parseArgs({ allowPositionals: true, options });
  const version = packageVersion();
  const notes = releaseNotes(positionals[0] ?? "", version);
  // Such as 1.0.0-beta.1: npm installs it on request only.
  const distributionTag = version.includes("-") ? "next" : "latest";
  print(`${values["distribution-tag"] ? distributionTag : notes}\n`);
});
