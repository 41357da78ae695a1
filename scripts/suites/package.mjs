/** Checks of the package before it is used: its form, its declarations, its sizes. */
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { homedir } from "node:os";
import { dirname, join, sep } from "node:path";
import { writeApiDocs } from "../lib/api-docs.mjs";
import { checkApiReport } from "../lib/api-report.mjs";
import { checkNotice } from "../lib/notices.mjs";
import { installDir, packageDir, repository, siteDir } from "../lib/paths.mjs";
import { attempt, nodeProgram, run } from "../lib/run.mjs";
import { buildSite } from "../lib/site.mjs";
import { runChecks } from "../lib/step.mjs";
import { kilobytes, sizes, wasmFile, wasmModules } from "../lib/wasm.mjs";
import { install, packed } from "./installed.mjs";

/** Limits in bytes; the tarball holds the core and the file readers twice, the second time in `inline.js` and `inline/`, and decoders of Draco and meshopt. */
const limits = { tarball: 3_035_000, pageScript: 134_300, elementScript: 85_500 };

/** How users' compilers find declarations. */
const resolutions = { node16: { module: "node16" }, bundler: { module: "esnext", moduleResolution: "bundler" } };

/**
 * Compiles code that uses the installed package as strictly as users may, its declarations included.
 * @param {keyof typeof resolutions} name
 */
async function compileStrictly(name) {
  await install();
  const project = join(installDir, `tsconfig.${name}.json`);
  const compilerOptions = {
    ...resolutions[name],
    strict: true,
    noEmit: true,
    declaration: true,
    target: "es2022",
    types: [],
  };
  // Nothing of the repository's: the compiler looks for packages in the folders above.
  const lib = ["es2022", "esnext.disposable", "dom", "dom.iterable"];
  const files = ["types", "inferred"].map((of) => `tests/js/${of}.test-d.ts`);
  writeFileSync(project, JSON.stringify({ compilerOptions: { ...compilerOptions, lib }, files }));
  const [node, tsc] = nodeProgram("typescript", "tsc");
  await run(node, [tsc, "--project", project]);
}

/**
 * @param {string} what
 * @param {number} bytes
 * @param {number} limit
 * @param {(note: string) => void} say
 */
function holdSize(what, bytes, limit, say) {
  if (bytes > limit) throw new Error(`${what}: ${kilobytes(bytes)}, over ${kilobytes(limit)}. Remedy: find what grew.`);
  say(`${kilobytes(bytes)} of ${kilobytes(limit)}`);
}

/** @param {boolean} isAll whether the API reference is written, which takes packages of its own */
export async function checkPackage(isAll) {
  const [node, publint] = nodeProgram("publint");
  const [, attw] = nodeProgram("@arethetypeswrong/cli", "attw");
  const { file, size } = await packed();
  return runChecks([
    ["publint", () => run(node, [publint, packageDir, "--strict"])],
    ["types, in modules' resolution", () => run(node, [attw, file, "--profile", "esm-only", "--no-emoji"])],
    ["tsc --strict, resolution node16", () => compileStrictly("node16")],
    ["tsc --strict, resolution bundler", () => compileStrictly("bundler")],
    ["npm publish --dry-run, without a correction", checkPublishing],
    ["the API report is up to date", checkApiReport],
    ["the notice names what the modules hold, under licences that are allowed", checkNotice],
    .../** @type {[string, () => unknown][]} */ (isAll ? [["the API reference, without a warning", writeApiDocs]] : []),
    ["size of the tarball", (say) => holdSize("The tarball", size, limits.tarball, say)],
    ...moduleChecks(),
    ["size of the page's script, gzipped, without the 3D library", checkPage],
    ["size of the element's script, gzipped, without the 3D library", checkElement],
  ]);
}

/** npm corrects a faulty manifest while it publishes, and says so in warnings only. */
async function checkPublishing() {
  // With a tag, npm does not ask the registry for the versions that are there.
  const args = ["publish", packageDir, "--dry-run", "--access", "public", "--tag", "latest"];
  const { output, reason } = await attempt("npm", args);
  const corrected = output.split("\n").filter((line) => /auto-corrected|errors corrected|invalid|cleaned/.test(line));
  if (reason || corrected.length > 0) {
    const found = reason || corrected.join("\n");
    throw new Error(`npm publish --dry-run: ${found}\nRemedy: \`npm pkg fix\` in pkg-config names what to correct.`);
  }
}

/** @returns {[title: string, check: (say: (note: string) => void) => unknown][]} */
function moduleChecks() {
  const modules = wasmModules.map((module) => ({ ...module, file: wasmFile(module, join(packageDir, "wasm")) }));
  return [
    ...modules.map(
      ({ name, budget, file }) =>
        /** @type {[string, (say: (note: string) => void) => unknown]} */ ([
          `size of the ${name} module, gzipped`,
          (say) => holdSize(name, sizes(file).gzip, budget, say),
        ]),
    ),
    ["the modules hold no path of the machine that built them", () => checkPaths(modules.map(({ file }) => file))],
    [
      "the modules have no instruction that browsers lack, or whose result differs, and the core has SIMD",
      () => checkFeatures(modules),
    ],
  ];
}

/**
 * All the script that the page loads until its first result is there: its own, and the package's with its worker.
 * @param {(note: string) => void} say
 */
async function checkPage(say) {
  await buildSite();
  const assets = join(siteDir, "assets");
  const html = readFileSync(join(siteDir, "index.html"), "utf8");
  const first = Array.from(html.matchAll(/(?:src|href)="\.\/assets\/([^"]+\.js)"/g), ([, name = ""]) => name);
  const later = readdirSync(assets).filter((name) => /^(worker|formats)-.*\.js$/.test(name));
  if (first.length === 0 || later.length !== 2) throw new Error(`Other scripts than expected: ${first}, ${later}.`);
  // Some of both are preloaded.
  const bytes = [...new Set([...first, ...later])].reduce((total, name) => total + sizes(join(assets, name)).gzip, 0);
  holdSize("The page's script", bytes, limits.pageScript, say);
}

/**
 * The script of `<sim3-align>`, and what it imports at once.
 * @param {(note: string) => void} say
 */
function checkElement(say) {
  const folder = join(packageDir, "element");
  const found = new Set([join(folder, "sim3-align.js")]);
  for (const file of found) {
    const imports = readFileSync(file, "utf8").matchAll(/(?:\bfrom|\bimport) ?"(\.[^"]+)"/g);
    for (const [, name = ""] of imports) found.add(join(dirname(file), name));
  }
  const bytes = [...found].reduce((total, file) => total + sizes(file).gzip, 0);
  if (found.size < 2) throw new Error(`${folder} is not as expected: its script imports nothing.`);
  holdSize("The element's script", bytes, limits.elementScript, say);
}

/** @param {readonly string[]} files */
function checkPaths(files) {
  for (const file of files) {
    const bytes = readFileSync(file);
    const found = [homedir(), repository].filter((path) => bytes.includes(`${path}${sep}`));
    if (found.length > 0) throw new Error(`${file} holds ${found}. Remedy: see rustFlags().`);
  }
}

/** The instructions that the modules may have: those of the oldest browsers that are supported. Relaxed SIMD is not among them. */
const features = ["bulk-memory", "bulk-memory-opt", "multivalue", "mutable-globals", "nontrapping-float-to-int"];
const baseline = [...features, "reference-types", "sign-ext"].map((feature) => `--enable-${feature}`);

/** The module whose speed depends on SIMD: it must have such instructions. */
const vectorised = "core";

/** @param {readonly { name: string, file: string }[]} modules */
async function checkFeatures(modules) {
  const [node, wasmOpt] = nodeProgram("binaryen", "wasm-opt");
  for (const { name, file } of modules) {
    // Without `-o` nothing is written: the module is read and validated.
    const validate = (/** @type {string[]} */ more) =>
      attempt(node, [wasmOpt, file, "--mvp-features", ...baseline, ...more]);
    const { output, reason } = await validate(["--enable-simd"]);
    const isScalar = !reason && name === vectorised && (await validate([])).reason === "";
    if (reason || isScalar) {
      const found = isScalar ? "no SIMD instruction" : output || reason;
      throw new Error(`The ${name} module: ${found}\nRemedy: see \`simd\` in scripts/lib/wasm.mjs.`);
    }
  }
}
