/** Formatters and linters, with warnings denied. */
import { at } from "../lib/paths.mjs";
import { nodeProgram, run } from "../lib/run.mjs";
import { wasmTarget } from "../lib/setup.mjs";
import { staticPackages } from "../lib/static-imports.mjs";
import { runChecks } from "./checks.mjs";

export function lint() {
  const clippy = (/** @type {readonly string[]} */ args) => () =>
    run("cargo", ["clippy", "--quiet", ...args, "--", "-D", "warnings"], { remedy: "correct what clippy names" });
  const [node, biome] = nodeProgram("@biomejs/biome", "biome");
  return runChecks([
    ["rustfmt", () => run("cargo", ["fmt", "--all", "--check"], { remedy: "npm run format" })],
    ["clippy, native", clippy(["--workspace", "--all-targets"])],
    ["clippy, WebAssembly", clippy(["--lib", "--target", wasmTarget])],
    ["biome", () => run(node, [biome, "ci", "--error-on-warnings"], { remedy: "npm run format, then what is left" })],
    ["commands start before any package is installed", checkCommands],
  ]);
}

/** `npm start` and `npm test` install what they need: nothing may be missing before they do. */
function checkCommands() {
  const commands = ["start", "test", "build", "build-www", "docs", "format"].map((name) =>
    at("scripts", `${name}.mjs`),
  );
  const early = commands.flatMap((command) => staticPackages(command));
  if (early.length === 0) return;
  const list = early.map(({ name, importer }) => `${name} in ${importer}`).join(", ");
  throw new Error(`They import ${list} at once. Remedy: \`await import(…)\` where it is used.`);
}

/** Type checks of what the build does not compile; they need the built package's declarations. */
export function types() {
  const [node, tsc] = nodeProgram("typescript", "tsc");
  return runChecks(
    ["pkg-config", "tests", "www", "scripts"].map((folder) => [
      `types of ${folder}/`,
      () => run(node, [tsc, "--noEmit", "--project", folder]),
    ]),
  );
}
