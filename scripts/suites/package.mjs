/** The package as its users get it: linted, installed from its tarball, and used. */
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { writeApiDocs } from "../lib/api-docs.mjs";
import { chromium, chromiumRemedy } from "../lib/chromium.mjs";
import { nodeCounts, noTests, withStatus } from "../lib/counts.mjs";
import { at, installDir, packageDir, repository } from "../lib/paths.mjs";
import { attempt, nodeProgram, run } from "../lib/run.mjs";
import { makeSample, sampleDir } from "../lib/sample.mjs";
import { buildSite } from "../lib/site.mjs";
import { digest, filesBelow, Stamp } from "../lib/stamp.mjs";
import { step } from "../lib/step.mjs";
import { kilobytes } from "../lib/wasm.mjs";
import { runChecks } from "./checks.mjs";

/** What the tarball may take, in bytes: the WebAssembly is in it twice, the second time in `inline.js`. */
const maxPacked = 1_200_000;

/** Tests that use the installed package, and what they share. */
const testFolders = ["js", "browser", "bundlers", "examples", "support"];

/** How users' compilers find declarations. */
const resolutions = { node16: { module: "node16" }, bundler: { module: "esnext", moduleResolution: "bundler" } };

/**
 * Compiles code that uses the installed package as strictly as users may, its declarations included.
 * @param {keyof typeof resolutions} name
 */
async function compileStrictly(name) {
  await install();
  const project = join(installDir, `tsconfig.${name}.json`);
  const compilerOptions = { ...resolutions[name], strict: true, noEmit: true, target: "es2022", types: [] };
  // Nothing of the repository's: it looks for packages in the folders above.
  const lib = ["es2022", "esnext.disposable", "dom", "dom.iterable"];
  const files = ["types", "conventions"].map((of) => `tests/js/${of}.test-d.ts`);
  writeFileSync(project, JSON.stringify({ compilerOptions: { ...compilerOptions, lib }, files }));
  const [node, tsc] = nodeProgram("typescript", "tsc");
  await run(node, [tsc, "--project", project]);
}

export async function lintPackage() {
  const [node, publint] = nodeProgram("publint");
  const [, attw] = nodeProgram("@arethetypeswrong/cli", "attw");
  const folder = at("target", "packed");
  mkdirSync(folder, { recursive: true });
  const [tarball] = JSON.parse(await run("npm", ["pack", packageDir, "--json", "--pack-destination", folder]));
  return runChecks([
    ["publint", () => run(node, [publint, packageDir, "--strict"])],
    [
      "types, in modules' resolution",
      () => run(node, [attw, join(folder, tarball.filename), "--profile", "esm-only", "--no-emoji"]),
    ],
    ["tsc --strict, resolution node16", () => compileStrictly("node16")],
    ["tsc --strict, resolution bundler", () => compileStrictly("bundler")],
    ["every file that package.json names is there", checkNamedFiles],
    ["the API reference, without a warning", writeApiDocs],
    [
      `the tarball is within ${kilobytes(maxPacked)}`,
      (say) => {
        if (tarball.size > maxPacked) throw new Error(`It has ${kilobytes(tarball.size)}. Remedy: find what grew.`);
        say(`${kilobytes(tarball.size)} packed, ${kilobytes(tarball.unpackedSize)} unpacked`);
      },
    ],
  ]);
}

function checkNamedFiles() {
  const { bin, exports } = JSON.parse(readFileSync(join(packageDir, "package.json"), "utf8"));
  /** @type {(entry: unknown) => string[]} */
  const targets = (entry) =>
    entry && typeof entry === "object" ? Object.values(entry).flatMap(targets) : [String(entry)];
  const named = [...targets(bin), ...targets(exports)].filter((path) => !path.includes("*"));
  const missing = named.filter((path) => !existsSync(join(packageDir, path)));
  if (missing.length > 0) throw new Error(`pkg/ lacks ${missing.join(", ")}, which its package.json names.`);
}

/** Packs pkg/ and installs the tarball into a folder of its own, then compiles the tests there. */
export async function install() {
  await step("install the packed package", async (say) => {
    const stamp = new Stamp(join(installDir, "installed-from"), digest([packageDir]), []);
    if (stamp.isCurrent) return say("up to date");
    rmSync(installDir, { recursive: true, force: true });
    mkdirSync(installDir, { recursive: true });
    const packed = JSON.parse(await run("npm", ["pack", packageDir, "--json", "--pack-destination", installDir]));
    const tarball = `./${packed[0].filename}`;
    const project = { private: true, type: "module", dependencies: { sim3align: `file:${tarball}` } };
    writeFileSync(join(installDir, "package.json"), JSON.stringify(project, null, 2));
    await run("npm", ["install", "--prefer-offline", "--no-audit", "--no-fund"], {
      cwd: installDir,
      remedy: "check that the npm registry can be reached: the package's own dependencies come from there",
    });
    stamp.write();
  });
  await step("compile the tests", async () => {
    rmSync(join(installDir, "tests"), { recursive: true, force: true });
    for (const folder of testFolders.filter((name) => existsSync(at("tests", name)))) {
      cpSync(at("tests", folder), join(installDir, "tests", folder), { recursive: true });
    }
    const tsconfig = { extends: at("tests", "tsconfig.installed.json"), include: ["tests"] };
    writeFileSync(join(installDir, "tsconfig.json"), JSON.stringify(tsconfig, null, 2));
    const [node, tsc] = nodeProgram("typescript", "tsc");
    await run(node, [tsc, "--project", installDir]);
  });
}

/**
 * Runs one folder of tests with the installed package.
 * @param {string} folder
 * @param {NodeJS.ProcessEnv} [env]
 */
async function nodeTest(folder, env = {}) {
  await makeSample();
  await install();
  return runCompiled(folder, env);
}

/**
 * Runs one folder of tests that {@link install} has compiled.
 * @param {string} folder
 * @param {NodeJS.ProcessEnv} [env]
 */
export async function runCompiled(folder, env = {}) {
  const files = filesBelow([join(installDir, "tests", folder)]).filter((file) => file.endsWith(".test.js"));
  if (files.length === 0) return noTests();
  const { output, reason } = await attempt(
    process.execPath,
    ["--enable-source-maps", "--test", "--test-reporter=spec", ...files],
    {
      cwd: installDir,
      echo: true,
      env: { SIM3ALIGN_REPOSITORY: repository, SIM3ALIGN_SAMPLE: sampleDir, ...env },
    },
  );
  return withStatus(nodeCounts(output), reason === "");
}

export const javaScript = () => nodeTest("js");

/** @param {string} folder of tests that show pages */
async function inBrowser(folder) {
  const path = await chromium();
  if (path) return nodeTest(folder, { CHROMIUM_PATH: path });
  console.log(`No Chromium. Remedy: ${chromiumRemedy}.`);
  // On a developer's machine that is a gap; in continuous integration it would hide every failure of the page.
  return { ...noTests(), ...(process.env.CI ? { failed: 1 } : { skipped: 1 }) };
}

export async function browser() {
  await buildSite();
  return inBrowser("browser");
}

/** The package in other people's apps. */
export const bundlers = () => inBrowser("bundlers");
