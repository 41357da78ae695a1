/** Formatters, linters and type checks, with warnings denied. */
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { filesBelow } from "../lib/cache.mjs";
import { at } from "../lib/paths.mjs";
import { nodeProgram, run } from "../lib/run.mjs";
import { setUp } from "../lib/setup.mjs";
import { runChecks } from "../lib/step.mjs";
import { checkFigures } from "../record/documents.mjs";
import { checkCodes, checkDocuments, checkNames } from "./documents.mjs";

/** Crates of the workspace besides the aligner. */
const crates = [
  ...["formats", "geometry", "lab", "physics", "runtime"],
  ...["core", "depth-files", "formats", "joint", "physics", "registration", "splats", "webp"].map(
    (name) => `modules/${name}`,
  ),
];

export async function lint() {
  await setUp();
  const clippy = ["clippy", "--quiet", "--workspace", "--all-targets", "--", "-D", "warnings"];
  const [node, biome] = nodeProgram("@biomejs/biome", "biome");
  const [, tsc] = nodeProgram("typescript", "tsc");
  return runChecks([
    ["rustfmt", () => run("cargo", ["fmt", "--all", "--check"], { remedy: "npm run format" })],
    ["clippy", () => run("cargo", clippy, { remedy: "correct what clippy names" })],
    ["biome", () => run(node, [biome, "ci", "--error-on-warnings"], { remedy: "npm run format, then what is left" })],
    ...["pkg-config", "tests", "www", "scripts"].map(
      (folder) =>
        /** @type {const} */ ([`types of ${folder}/`, () => run(node, [tsc, "--noEmit", "--project", folder])]),
    ),
    ["links and commands of the documents", checkDocuments],
    ["names, formats and sizes in documents and comments", checkNames],
    ["figures of the record in documents", checkFigures],
    ["codes of the guide on errors", checkCodes],
    ["commands start before any package is installed", checkCommands],
    ["all Rust tests are in test programs", checkTests],
  ]);
}

/** `npm start` and `npm test` install what they need: no npm package may be missing before they do. */
function checkCommands() {
  const modules = ["start", "test", "make"].map((name) => at("scripts", `${name}.mjs`));
  const early = [];
  for (const path of modules) {
    const statements = readFileSync(path, "utf8").matchAll(
      /^(?:import|export)\b[^;]*?\bfrom "([^"]+)"|^import "([^"]+)"/gm,
    );
    for (const [, from, bare] of statements) {
      const name = from ?? bare ?? "";
      const file = join(dirname(path), name);
      if (name.startsWith(".") && !modules.includes(file)) modules.push(file);
      else if (!/^(\.|node:)/.test(name)) early.push(`${name} in ${path}`);
    }
  }
  if (early.length > 0) {
    throw new Error(`They import ${early.join(", ")} at once. Remedy: \`await import(…)\` where it is used.`);
  }
}

/** Tests in a library are a second program to compile, and `test = false` leaves them out: none may be there. */
function checkTests() {
  const sources = filesBelow(["src", ...crates.map((name) => join(name, "src"))].map((folder) => at(folder)));
  const found = sources.filter((file) => /^\s*#\[(test|cfg\(test\))\]/m.test(readFileSync(file, "utf8")));
  if (found.length > 0)
    throw new Error(
      `${found.join(", ")}: never run. Remedy: move the tests to tests/suite, of the repository or of the crate.`,
    );
}
