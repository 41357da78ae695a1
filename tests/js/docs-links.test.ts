/** The documentation's references: links, and the codes that the guide on errors has to have. */
import assert from "node:assert/strict";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { repository } from "../support/environment.js";

const text = (path: string) => readFileSync(join(repository, path), "utf8");

/** Markdown files of a folder, without what is installed or made. */
function documents(folder: string): string[] {
  return readdirSync(join(repository, folder), { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) return entry.name === "node_modules" ? [] : documents(path);
    return entry.name.endsWith(".md") ? [path] : [];
  });
}

/** The headings' anchors, as GitHub and npm make them. */
function anchors(path: string): string[] {
  return [...text(path).matchAll(/^#+ (.*)$/gm)].map(([, title = ""]) =>
    title
      .toLowerCase()
      .replace(/[^\p{L}\p{N} _-]/gu, "")
      .replaceAll(" ", "-"),
  );
}

/** What `npm run bench -- --snapshot` writes, on whoever's machine has the time. */
const snapshots = [join("docs", "benchmark", "README.md")];

const paths = [
  ...["README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md"],
  ...documents("docs"),
  ...documents("examples"),
];
for (const path of paths) {
  test(`${path}: every link leads somewhere`, () => {
    const links = [...text(path).matchAll(/\]\(([^)\s]+)\)/g)].map(([, link = ""]) => link);
    for (const link of links.filter((target) => !/^https?:/.test(target))) {
      const [file = "", anchor] = link.split("#");
      const target = file === "" ? path : join(dirname(path), file);
      if (snapshots.includes(target)) continue;
      assert.ok(existsSync(join(repository, target)), `${link}: there is no ${target}`);
      if (anchor !== undefined) assert.ok(anchors(target).includes(anchor), `${link}: no such heading`);
    }
  });
}

test("the commands that documents name exist", () => {
  const { scripts } = JSON.parse(text("package.json"));
  const labNames = [...text(join("lab", "src", "main.rs")).matchAll(/^ {4}([A-Z]\w+)\(/gm)].map(([, name = ""]) =>
    name.toLowerCase(),
  );
  const names = (pattern: RegExp) =>
    paths.flatMap((path) => [...text(path).matchAll(pattern)].map(([, name = ""]) => ({ path, name })));
  const run = names(/npm run ([a-z][\w:-]*)/g).filter(({ path }) => !path.startsWith("examples"));
  const lab = names(/(?:`sim3align-lab|cargo run [^`\n]*sim3align-lab [^`\n]*?--) ([a-z]+)/g);
  assert.ok(run.length > 40 && lab.length > 10, `${run.length} and ${lab.length} are named`);
  for (const { path, name } of run) assert.ok(name in scripts, `${path}: npm run ${name}`);
  for (const { path, name } of lab) assert.ok(labNames.includes(name), `${path}: sim3align-lab ${name}`);
});

const guide = join("docs", "guides", "troubleshooting.md");

/** The headings of one level that are codes. */
const codesAt = (level: string) =>
  [...text(guide).matchAll(new RegExp(`^${level} \`([A-Z_0-9]+)\`$`, "gm"))].map(([, code = ""]) => code).sort();

/** What a pattern finds in a source file, without repetitions. */
function codesIn(path: string, pattern: RegExp): string[] {
  const found = [...text(path).matchAll(pattern)].map(([, code = ""]) => code);
  assert.ok(found.length > 0, `${path} has no codes any more where they are looked for`);
  return found;
}

test("every error's code has a section: its cause, an example and a fix", () => {
  const core = codesIn(join("geometry", "src", "error.rs"), /=> "([A-Z_0-9]+)"/g);
  const skin = codesIn(join("pkg-config", "src", "error.ts"), /^ {2}\| "([A-Z_0-9]+)"/gm);
  assert.deepEqual(codesAt("###"), [...core, ...skin].sort());
  for (const section of text(guide).split(/^### /m).slice(1)) {
    const [title = ""] = section.split("\n");
    for (const part of ["**Cause.**", "**Example.**", "**Fix.**"])
      assert.ok(section.includes(part), `${title}: ${part}`);
    const code = title.replaceAll("`", "");
    for (const [, thrown] of section.matchAll(/^```ts throws (\w+)$/gm)) assert.equal(thrown, code);
  }
});

test("every warning's code has a section", () => {
  const generated = text(join("pkg-config", "src", "generated", "types.ts"));
  const line = /export type WarningCode = (.*);/.exec(generated)?.[1] ?? "";
  const codes = [...line.matchAll(/"([A-Z_]+)"/g)].map(([, code = ""]) => code);
  assert.ok(codes.length > 0);
  assert.deepEqual(codesAt("####"), codes.sort());
});

test("the README's picture is there, and is small", () => {
  assert.match(text("README.md"), /!\[[^\]]+\]\(docs\/picture\.png\)/);
  assert.ok(readFileSync(join(repository, "docs", "picture.png")).length <= 100_000);
});

test("the pictures of how it works are small together, and all are shown", () => {
  const folder = join("docs", "how-it-works");
  const names = readdirSync(join(repository, folder));
  const sizes = names.map((name) => readFileSync(join(repository, folder, name)).length);
  assert.ok(sizes.reduce((sum, size) => sum + size, 0) <= 400_000);
  for (const name of names) assert.ok(text(`${folder}.md`).includes(`(how-it-works/${name})`), name);
});
