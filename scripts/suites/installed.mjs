/** Tests on the package as its users install it: in Node, in a browser, and by the examples. */
import { cpSync, mkdirSync, readdirSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { availableParallelism } from "node:os";
import { basename, join } from "node:path";
import { cached, digest, filesBelow, once } from "../lib/cache.mjs";
import { hungFiles, nodeCounts, noTests, sum, withStatus } from "../lib/counts.mjs";
import { print } from "../lib/output.mjs";
import { at, installDir, packageDir, repository, sampleDir } from "../lib/paths.mjs";
import { chromium, chromiumRemedy, firefox, redisServer } from "../lib/programs.mjs";
import { installedPython } from "../lib/python.mjs";
import { attempt, nodeProgram, run } from "../lib/run.mjs";
import { copySample } from "../lib/sample.mjs";
import { buildSite } from "../lib/site.mjs";
import { step } from "../lib/step.mjs";

/** The environment of the tests. */
export const testEnvironment = { SIM3ALIGN_REPOSITORY: repository, SIM3ALIGN_SAMPLE: sampleDir };

/** Tests that use the installed package, and what they share. */
const testFolders = ["js", "repro", "browser", "bundlers", "examples", "support"];

/** Far longer than any file of tests takes, on a busy machine too. */
const HANGING_MINUTES = 15;

/** The package's tarball: its file, and its size in bytes. */
export const packed = once(async () => {
  const folder = at("target", "packed");
  mkdirSync(folder, { recursive: true });
  const [{ filename, size }] = JSON.parse(
    await run("npm", ["pack", packageDir, "--json", "--pack-destination", folder]),
  );
  return { file: join(folder, filename), size: Number(size) };
});

/** Packs pkg/, installs the tarball into a folder of its own, and compiles the tests there. */
export const install = once(async () => {
  await copySample();
  await step("install the packed package", async (say) => {
    const isNew = await cached(join(installDir, "installed-from"), digest([packageDir]), [], async () => {
      rmSync(installDir, { recursive: true, force: true });
      const { file } = await packed();
      mkdirSync(installDir, { recursive: true });
      const project = { private: true, type: "module", dependencies: { sim3align: `file:${file}` } };
      writeFileSync(join(installDir, "package.json"), JSON.stringify(project, null, 2));
      await run("npm", ["install", "--prefer-offline", "--no-audit", "--no-fund"], {
        cwd: installDir,
        remedy: "check that the npm registry can be reached: the package's own dependencies come from there",
      });
    });
    if (!isNew) say("up to date");
  });
  await step("compile the tests", async () => {
    rmSync(join(installDir, "tests"), { recursive: true, force: true });
    for (const folder of testFolders)
      cpSync(at("tests", folder), join(installDir, "tests", folder), { recursive: true });
    const tsconfig = { extends: at("tests", "tsconfig.installed.json"), include: ["tests"] };
    writeFileSync(join(installDir, "tsconfig.json"), JSON.stringify(tsconfig, null, 2));
    const [node, tsc] = nodeProgram("typescript", "tsc");
    await run(node, [tsc, "--project", installDir]);
  });
});

/**
 * @typedef {object} TestOptions
 * @property {NodeJS.ProcessEnv} [env]
 * @property {number} [concurrency] files at a time
 * @property {readonly string[]} [without] names of files that are left out
 */

/**
 * Runs folders of tests with the installed package.
 * @param {readonly string[]} folders
 * @param {TestOptions} [options]
 */
async function nodeTest(folders, { env = {}, concurrency = availableParallelism(), without = [] } = {}) {
  await install();
  // By default, Node leaves one core free, and waits for ever for a test that hangs. Its versions before 20.11 know no
  // other way.
  const [major = 0, minor = 0] = process.versions.node.split(".").map(Number);
  const all = [`--test-concurrency=${concurrency}`, `--test-timeout=${HANGING_MINUTES * 60_000}`];
  const options = major > 20 || minor >= 11 ? all : [];
  const test = (/** @type {readonly string[]} */ files) =>
    attempt(process.execPath, ["--enable-source-maps", "--test", "--test-reporter=spec", ...options, ...files], {
      cwd: installDir,
      echo: true,
      env: { ...testEnvironment, ...env },
    });
  const counted = (/** @type {Awaited<ReturnType<typeof test>>} */ { output, reason }) =>
    withStatus(nodeCounts(output), reason === "");
  const filesIn = (/** @type {string} */ folder) =>
    readdirSync(join(installDir, "tests", folder))
      .filter((name) => name.endsWith(".test.js") && !without.includes(name.replace(".test.js", "")))
      .map((name) => join(installDir, "tests", folder, name));
  const outcome = await test(folders.flatMap(filesIn));
  const hung = hungFiles(outcome.output);
  if (hung.length === 0) return counted(outcome);
  // Once more, because Node itself may hang: its end can deadlock (nodejs/node#54918).
  print(`\nOnce more, because they hung: ${hung.join(", ")}\n`);
  const counts = nodeCounts(outcome.output);
  return sum([{ ...counts, failed: counts.failed - hung.length }, counted(await test(hung))]);
}

/** @param {boolean} isAll whether the tests that need packages of Python get them */
export async function javaScript(isAll) {
  const pythons = { SIM3ALIGN_SIMULATORS: "simulators", SIM3ALIGN_NOTEBOOKS: "notebooks" };
  /** @type {NodeJS.ProcessEnv} */
  const env = {};
  for (const [name, folder] of isAll ? Object.entries(pythons) : []) {
    const python = await installedPython(folder);
    if (python !== undefined) env[name] = python;
  }
  return nodeTest(["js", "repro"], { env });
}

/** Counts where a program is missing: skipped on a developer's machine, failed in continuous integration. */
export const missing = () => ({ ...noTests(), ...(process.env.CI ? { failed: 1 } : { skipped: 1 }) });

/** Tests that show pages spend half of their time waiting for a browser. @param {string} folder */
export async function inBrowser(folder) {
  const path = await chromium();
  const env = { CHROMIUM_PATH: path, FIREFOX_PATH: await firefox() };
  if (path) return nodeTest([folder], { env, concurrency: 2 * availableParallelism() });
  print(`No Chromium. Remedy: ${chromiumRemedy}.\n`);
  return missing();
}

export async function browser() {
  await buildSite();
  return inBrowser("browser");
}

/** A copy of what the examples use: the unpacked tarball as pkg/, and the examples. */
const copy = at("target", "examples");
export const examplesDir = join(copy, "examples");

/** Files that working in the examples' folder leaves there. */
const made = new Set(["node_modules", "sample", "dist", "annotation", "annotations"]);
const isSource = (/** @type {string} */ path) => !made.has(basename(path));

async function installExamples() {
  const sources = readdirSync(at("examples")).filter(isSource);
  const manifests = filesBelow(sources.map((name) => at("examples", name))).filter((path) =>
    /^(package(-lock)?\.json|\.npmrc)$/.test(basename(path)),
  );
  const outputs = [join(examplesDir, "node_modules")];
  await cached(join(copy, "installed-from"), digest([packageDir, ...manifests]), outputs, async () => {
    rmSync(copy, { recursive: true, force: true });
    mkdirSync(copy, { recursive: true });
    await run("tar", ["-xzf", (await packed()).file], { cwd: copy });
    renameSync(join(copy, "package"), join(copy, "pkg"));
    cpSync(at("examples"), examplesDir, { recursive: true, filter: isSource });
    await run("npm", ["ci", "--prefer-offline"], {
      cwd: examplesDir,
      remedy: "check that the npm registry can be reached, and that examples/package-lock.json is up to date",
    });
  });
  cpSync(at("examples"), examplesDir, { recursive: true, filter: isSource });
  cpSync(sampleDir, join(examplesDir, "sample", "mug"), { recursive: true });
}

/** Tests that start servers, build an app twice, or compile it. */
const heavyExamples = ["cluster", "react-server", "react-types"];

/** The examples, each as its user runs it. @param {boolean} isAll */
export async function examples(isAll) {
  await install();
  await buildSite();
  await step("install the examples", installExamples);
  const [chromiumPath = "", redisPath = ""] = [await chromium(), isAll ? await redisServer() : ""];
  const env = { SIM3ALIGN_EXAMPLES: examplesDir, CHROMIUM_PATH: chromiumPath, REDIS_SERVER_PATH: redisPath };
  return nodeTest(["examples"], { env, without: isAll ? [] : heavyExamples });
}
