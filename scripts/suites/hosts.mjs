/**
 * The package where its users run it: in bundlers' apps, and in other runtimes than the one at hand: Node's oldest and
 * newest version, Deno, Bun and Cloudflare's workerd, whose programs are npm packages.
 */
import { existsSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { print } from "../lib/output.mjs";
import { at, installDir } from "../lib/paths.mjs";
import { attempt, run } from "../lib/run.mjs";
import { runChecks, step } from "../lib/step.mjs";
import { wasmModules } from "../lib/wasm.mjs";
import { inBrowser, install, missing } from "./installed.mjs";

/** Apps of Vite, webpack and esbuild. */
export const bundlers = () => inBrowser("bundlers");

/** 800 MB, which nothing else needs: they are not among the repository's own packages. */
const packages = {
  bun: "1.4.5",
  deno: "2.9.6",
  "node-newest": "npm:node@26.10.0",
  // The oldest version that the package's `engines` allow.
  "node-oldest": "npm:node@20.0.0",
  workerd: "1.20261117.1",
};
const folder = at("target", "runtimes");
/** @param {string} name */
const program = (name) =>
  name.startsWith("node-")
    ? join(folder, "node_modules", name, "bin", "node")
    : join(folder, "node_modules", ".bin", name);

/** Installs the runtimes where they are missing; whether each runs. */
async function installed() {
  const runs = async (/** @type {string} */ name) => (await attempt(program(name), ["--version"])).reason === "";
  const present = async () => (await Promise.all(Object.keys(packages).map(runs))).every(Boolean);
  if (await present()) return true;
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, "package.json"), JSON.stringify({ private: true, dependencies: packages }));
  const names = Object.keys(packages).join(", ");
  await step(`install ${names}`, () => attempt("npm", ["install", "--no-audit", "--no-fund"], { cwd: folder }));
  return present();
}

/** All runtimes give Node's results, to the bit. */
export async function runtimes() {
  if (!(await installed())) {
    print("Other runtimes can't be installed here. Remedy: let npm run their install scripts.\n");
    return missing();
  }
  await install();
  const script = join(installDir, "tests", "bundlers", "runtime.js");
  const expected = await run(process.execPath, [script], { cwd: installDir });
  const same = (/** @type {string} */ name, /** @type {readonly string[]} */ args) => async () => {
    hold(await run(program(name), [...args, script], { cwd: installDir }), expected);
  };
  return runChecks([
    ["Node 20.0", same("node-oldest", [])],
    ["Node 26", same("node-newest", [])],
    ["Deno, allowed to read files", same("deno", ["run", "--no-lock", "--allow-read"])],
    ["Bun", same("bun", ["run"])],
    ["workerd, given the compiled modules", () => checkWorkerd(JSON.parse(expected)[0])],
  ]);
}

/**
 * @param {string} output
 * @param {string} expected
 */
function hold(output, expected) {
  if (output.trim() !== expected.trim()) throw new Error(`It finds\n${output}\nwhere Node finds\n${expected}`);
}

/**
 * As `wrangler` does it: the script is bundled, modules of WebAssembly stay files, and come compiled.
 * @param {Record<string, number[]>} expected
 */
async function checkWorkerd(expected) {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const outdir = join(folder, "workerd");
  await build({
    entryPoints: [join(installDir, "tests", "bundlers", "workerd.js")],
    ...{ bundle: true, format: "esm", outdir, loader: { ".wasm": "copy" }, assetNames: "[name]", logLevel: "silent" },
  });
  // The main entry does not import all of them.
  const wasm = wasmModules.map(({ name }) => `${name}_bg.wasm`).filter((name) => existsSync(join(outdir, name)));
  const modules = [
    `(name = "main", esModule = embed "workerd.js")`,
    ...wasm.map((name) => `(name = "./${name}", wasm = embed "${name}")`),
  ];
  const config = join(outdir, "config.capnp");
  writeFileSync(
    config,
    `using Workerd = import "/workerd/workerd.capnp";
const config :Workerd.Config = (services = [(name = "main", worker = .main)]);
const main :Workerd.Worker = (compatibilityDate = "2025-01-01", modules = [${modules.join(", ")}]);
`,
  );
  const alone = Object.entries(expected).filter(([name]) => /^\w+, 0\b/.test(name));
  const outcome = { found: Object.fromEntries(alone), code: "WORKER_FAILED" };
  hold(await run(program("workerd"), ["test", config]), JSON.stringify(outcome));
}
