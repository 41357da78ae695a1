/** The two WebAssembly modules. */
import { cpSync, existsSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { homedir } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { shortenImports } from "./imports.mjs";
import { at, glueDir, repository } from "./paths.mjs";
import { nodeProgram, run } from "./run.mjs";
import { wasmBindgenProgram, wasmBindgenVersion, wasmTarget } from "./setup.mjs";
import { digest, Stamp } from "./stamp.mjs";
import { step } from "./step.mjs";

/**
 * @typedef {object} WasmModule
 * @property {string} name of the generated files
 * @property {string} crate that it is built from
 * @property {number} budget bytes, gzipped
 */

/** @type {readonly WasmModule[]} */
export const wasmModules = [
  { name: "core", crate: "sim3align", budget: 160_000 },
  { name: "formats", crate: "sim3align-formats", budget: 260_000 },
];

const optimise = [
  // By name, functions of a kind are neighbours, and pack the better: 0.7 kB gzipped.
  ...["-O3", "--converge", "--reorder-functions-by-name", "--strip-debug", "--strip-producers"],
  // What the compiler was allowed to use is for linkers to know.
  "--strip-target-features",
  // Inlining was the compiler's affair, which knows what is hot; more of it makes the modules 2 kB gzipped larger.
  ...["--one-caller-inline-max-function-size=0", "--flexible-inline-max-function-size=0"],
];

/**
 * What LLVM copies for speed's sake. Its own limits suit processors that run what it writes; here another compiler
 * follows, and copies cost download: together these make the core 10 kB gzipped smaller, `precise` no slower, and
 * `paper` by a fifteenth.
 */
const llvm = [
  // How much a function may cost to be copied to its callers, and a loop's body to be written out.
  ...["-inline-threshold=50", "-unroll-threshold=40", "-unroll-runtime=false", "-unroll-allow-peeling=false"],
  // Loops and branches are not copied for every case of a condition.
  ...["-enable-nontrivial-unswitch=false", "-jump-threading-threshold=1"],
  // Nor what is known on one way to a place, to all the others.
  ...["-enable-pre=false", "-enable-load-pre=false"],
  // No pointer of its own for every access in a loop: base and index are one instruction in WebAssembly.
  "-disable-lsr",
].map((option) => `-Cllvm-args=${option}`);

/**
 * The module's file.
 * @param {WasmModule} module
 * @param {string} [folder]
 */
export const wasmFile = ({ name }, folder = glueDir) => join(folder, `${name}_bg.wasm`);

/**
 * Size as it is and gzipped, in bytes.
 * @param {string} file
 */
export function sizes(file) {
  const bytes = readFileSync(file);
  return { raw: bytes.length, gzip: gzipSync(bytes, { level: 9 }).length };
}

/**
 * Bytes for people: kB is 1000 bytes.
 * @param {number} bytes
 */
export const kilobytes = (bytes) => `${(bytes / 1000).toFixed(1)} kB`;

/**
 * Builds the modules whose inputs have changed, and puts them with their glue beside the TypeScript.
 * @returns {Promise<void>}
 */
export async function buildWasm() {
  const rustc = (await run("rustc", ["--version", "--verbose"])).trim();
  for (const module of wasmModules) {
    await step(`${module.name} module`, (say) => buildModule(module, rustc, say));
  }
}

/**
 * @param {WasmModule} module
 * @param {string} rustc
 * @param {(note: string) => void} say
 */
async function buildModule(module, rustc, say) {
  const outputs = [`${module.name}.js`, `${module.name}.d.ts`, `${module.name}_bg.wasm`, `${module.name}_bg.wasm.d.ts`];
  const sources = ["src", "geometry", "formats", "Cargo.toml", "Cargo.lock", ".cargo", "scripts/lib/wasm.mjs", "scripts/lib/imports.mjs"].map(
    (path) => at(path),
  );
  const facts = [rustc, wasmBindgenVersion(), binaryenVersion(), process.env.RUSTFLAGS ?? ""];
  const stamp = new Stamp(
    at("target", "wasm", `${module.name}.stamp`),
    digest(sources, facts),
    outputs.map((name) => join(glueDir, name)),
  );
  const size = () => {
    const { raw, gzip } = sizes(wasmFile(module));
    return `${kilobytes(raw)}, ${kilobytes(gzip)} gzipped`;
  };
  if (stamp.isCurrent) return say(`${size()}, up to date`);
  stamp.clear();

  const compiled = at("target", wasmTarget, "release", `${module.crate.replace("-", "_")}.wasm`);
  await run("cargo", ["build", "--release", "--lib", "--target", wasmTarget, "--package", module.crate], {
    env: { CARGO_ENCODED_RUSTFLAGS: await rustFlags() },
  });

  const folder = at("target", "wasm", module.name);
  rmSync(folder, { recursive: true, force: true });
  await run(wasmBindgenProgram("wasm-bindgen"), [
    ...[compiled, "--target", "web", "--out-name", module.name, "--out-dir", folder],
    // After a trap the skin gives the module a new instance.
    "--experimental-reset-state-function",
  ]);
  const bare = wasmFile(module, folder);
  const [node, wasmOpt] = nodeProgram("binaryen", "wasm-opt");
  await run(node, [wasmOpt, bare, ...optimise, "-o", bare]);
  shortenImports(bare, join(folder, `${module.name}.js`));

  cpSync(folder, glueDir, { recursive: true });
  stamp.write();
  say(size());
}

/**
 * LLVM's limits, and flags that keep the builder's own paths out of the published module: the compiler puts the
 * places of possible panics into it.
 */
async function rustFlags() {
  // Unpacks the sources; their folder's name is cargo's to choose.
  await run("cargo", ["fetch", "--locked", "--target", wasmTarget]);
  const sources = join(process.env.CARGO_HOME ?? join(homedir(), ".cargo"), "registry", "src");
  const folders = existsSync(sources) ? readdirSync(sources) : [];
  const remapped = [...folders.map((folder) => `${join(sources, folder)}=crates`), `${repository}=.`];
  const given = process.env.RUSTFLAGS?.split(" ").filter(Boolean) ?? [];
  return [...given, ...llvm, ...remapped.map((mapping) => `--remap-path-prefix=${mapping}`)].join("\x1f");
}

/** @returns {string} */
export function binaryenVersion() {
  return JSON.parse(readFileSync(at("node_modules", "binaryen", "package.json"), "utf8")).version;
}
