/** What is checked before a version is published, and how it is published. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { repository } from "../support/environment.js";
import { scriptModule } from "../support/internals.js";

const { distributionTag, releaseNotes, sectionOf } = await scriptModule("lib/release.mjs");

const changelog =
  "# Changelog\n\n## [Unreleased]\n\n## [1.1.0] - 2030-01-02\n\n### Added\n\n- New.\n\n## [1.0.0]\n\n- Old.\n";
const citation = "type: software\nversion: 1.1.0\ndate-released: 2030-01-02\n";

test("the notes of a release are the section of its version", () => {
  assert.equal(releaseNotes("v1.1.0", "1.1.0", changelog, citation), "### Added\n\n- New.");
  assert.equal(sectionOf(changelog, "1.0.0"), "- Old.");
});

test("a release needs its version's tag and section, and leaves nothing unreleased", () => {
  assert.throws(
    () => releaseNotes("v1.0.0", "1.1.0", changelog, citation),
    /The tag is v1\.0\.0, the package has version 1\.1\.0/,
  );
  assert.throws(() => releaseNotes("1.1.0", "1.1.0", changelog, citation), /tag v1\.1\.0/);
  assert.throws(() => releaseNotes("v1.2.0", "1.2.0", changelog, citation), /says nothing of 1\.2\.0/);
  assert.throws(() => releaseNotes("v1.1", "1.1", changelog, citation), /says nothing of 1\.1\./);
  const unreleased = changelog.replace("[Unreleased]\n", "[Unreleased]\n\n- Later.\n");
  assert.throws(() => releaseNotes("v1.1.0", "1.1.0", unreleased, citation), /unreleased changes/);
});

test("a release has a date, and the citation names both", () => {
  assert.throws(() => releaseNotes("v1.0.0", "1.0.0", changelog, citation), /no date of 1\.0\.0/);
  const without = (line: string) => citation.replace(`${line}\n`, "");
  for (const line of ["version: 1.1.0", "date-released: 2030-01-02"]) {
    assert.throws(
      () => releaseNotes("v1.1.0", "1.1.0", changelog, without(line)),
      new RegExp(`does not say "${line}"`),
    );
  }
});

test("prereleases are installed on request only", () => {
  assert.equal(distributionTag("1.0.0"), "latest");
  assert.equal(distributionTag("1.1.0-rc.1"), "next");
});

test("the changelog has a section of the unreleased changes or of the version", () => {
  const text = readFileSync(join(repository, "CHANGELOG.md"), "utf8");
  const { version } = JSON.parse(readFileSync(join(repository, "pkg-config", "package.json"), "utf8"));
  assert.ok(sectionOf(text, "Unreleased") || sectionOf(text, version));
});

const workflow = readFileSync(join(repository, ".github", "workflows", "release.yml"), "utf8");
/** The jobs of the workflow by their names, as text. */
const jobs = Object.fromEntries(
  workflow
    .slice(workflow.indexOf("\njobs:\n"))
    .split(/^(?= {2}\w+:$)/m)
    .slice(1)
    .map((text) => [text.trim().split(":")[0] as string, text]),
);

test("the workflow publishes with provenance, and only after the checks", () => {
  const steps = ["scripts/release.mjs", ".ci/run", "npm pack", "npm publish"].map((text) => workflow.indexOf(text));
  assert.ok(
    steps.every((at, i) => at > (steps[i - 1] ?? 0)),
    `${steps}`,
  );
  assert.match(workflow, /npm publish .*--provenance/);
});

test("what may publish runs no code of the repository, and what runs it may not write", () => {
  assert.deepEqual(Object.keys(jobs), ["test", "publish"]);
  const { test: tests = "", publish = "" } = jobs;
  assert.match(workflow, /^permissions: \{\}$/m);
  assert.doesNotMatch(tests, /: write|secrets\.|GH_TOKEN/);
  assert.match(tests, /persist-credentials: false/);
  assert.match(publish, /^ {4}needs: test$/m);
  assert.match(publish, /id-token: write/);
  assert.doesNotMatch(publish, /checkout|scripts\/|\.ci\/|npm (ci|install|run|exec)|npx/);
});

test("actions are pinned to commits", () => {
  const used = [...workflow.matchAll(/uses: (.*)/g)].map(([, action]) => action);
  assert.ok(used.length >= 4);
  for (const action of used) assert.match(action ?? "", /^[\w-]+\/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+$/);
});
