/** The WebAssembly modules with their JavaScript glue. */
import { cpSync, existsSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { homedir } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { cached, digest, once } from "./cache.mjs";
import { writeDecoders } from "./decoders.mjs";
import { at, glueDir, repository } from "./paths.mjs";
import { nodeProgram, run } from "./run.mjs";
import { bindgenProgram, npmPackages, rustToolchain, wasmBindgen, wasmBindgenVersion, wasmTarget } from "./setup.mjs";
import { step } from "./step.mjs";

/**
 * @typedef {object} WasmModule
 * @property {string} name of the generated files
 * @property {string} crate
 * @property {number} budget bytes, gzipped
 */

/** @type {readonly WasmModule[]} */
export const wasmModules = [
  { name: "core", crate: "sim3align-core", budget: 195_000 },
  { name: "joint", crate: "sim3align-joint", budget: 312_000 },
  { name: "registration", crate: "sim3align-registration", budget: 148_500 },
  { name: "formats", crate: "sim3align-module-formats", budget: 264_000 },
  { name: "depth-files", crate: "sim3align-depth-files", budget: 245_000 },
  { name: "splats", crate: "sim3align-splats", budget: 62_000 },
  { name: "webp", crate: "sim3align-webp", budget: 82_000 },
  { name: "physics", crate: "sim3align-module-physics", budget: 79_000 },
];

const optimise = ["-O3", "--strip-debug", "--strip-producers", "--strip-target-features"];

/**
 * The module's file.
 * @param {WasmModule} module
 * @param {string} [folder]
 */
export const wasmFile = ({ name }, folder = glueDir) => join(folder, `${name}_bg.wasm`);

/**
 * Raw and gzipped size, in bytes.
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

/** Compiles all crates at once. */
const compiled = once(async () => {
  await rustToolchain();
  await step("WebAssembly", async () => {
    const crates = wasmModules.flatMap(({ crate }) => ["--package", crate]);
    await run("cargo", ["build", "--release", "--lib", "--target", wasmTarget, ...crates], {
      env: { CARGO_ENCODED_RUSTFLAGS: await rustFlags() },
    });
  });
});

/** Builds the modules, and puts those that have changed with their glue beside the TypeScript. */
export const buildWasm = once(async () => {
  await Promise.all([npmPackages(), wasmBindgen(), compiled()]);
  writeDecoders();
  await Promise.all(wasmModules.map((module) => step(`${module.name} module`, (say) => writeModule(module, say))));
});

/**
 * @param {WasmModule} module
 * @param {(note: string) => void} say
 */
async function writeModule(module, say) {
  const { name, crate } = module;
  const input = at("target", wasmTarget, "release", `${crate.replaceAll("-", "_")}.wasm`);
  const inputs = digest(
    [input, at("scripts", "bindgen", "src")],
    [wasmBindgenVersion(), binaryenVersion(), ...optimise],
  );
  const outputs = [".js", ".d.ts", "_bg.wasm", "_bg.wasm.d.ts"].map((ending) => join(glueDir, `${name}${ending}`));
  const isNew = await cached(at("target", "wasm", `${name}.stamp`), inputs, outputs, async () => {
    const folder = at("target", "wasm", name);
    rmSync(folder, { recursive: true, force: true });
    await run(bindgenProgram, ["web", input, folder, name]);
    const [node, wasmOpt] = nodeProgram("binaryen", "wasm-opt");
    await run(node, [wasmOpt, wasmFile(module, folder), ...optimise, "-o", wasmFile(module, folder)]);
    cpSync(folder, glueDir, { recursive: true });
  });
  const { raw, gzip } = sizes(wasmFile(module));
  say(`${kilobytes(raw)}, ${kilobytes(gzip)} gzipped${isNew ? "" : ", up to date"}`);
}

/**
 * Limits on what LLVM copies for speed's sake: engines compile the module again, and every copy is downloaded. Alone, each
 * makes the core smaller by more than 3 %, and the search no slower.
 */
const llvm = ["-inline-threshold=50", "-disable-lsr"].map((option) => `-Cllvm-args=${option}`);

/** In Chrome 91, Firefox 89 and Safari 16.4. Unlike those of relaxed SIMD, the results are the same everywhere. */
const simd = ["-Ctarget-feature=+simd128"];

/** Flags that keep the builder's paths out of the modules: the compiler writes the places of possible panics into them. */
async function rustFlags() {
  // Unpacks the sources below a folder that cargo names after the registry.
  await run("cargo", ["fetch", "--locked", "--target", wasmTarget]);
  const sources = join(process.env.CARGO_HOME ?? join(homedir(), ".cargo"), "registry", "src");
  const folders = existsSync(sources) ? readdirSync(sources) : [];
  const mappings = [...folders.map((folder) => `${join(sources, folder)}=crates`), `${repository}=.`];
  const given = process.env.RUSTFLAGS?.split(" ").filter(Boolean) ?? [];
  return [...given, ...simd, ...llvm, ...mappings.map((mapping) => `--remap-path-prefix=${mapping}`)].join("\x1f");
}

/** @returns {string} */
export const binaryenVersion = () =>
  JSON.parse(readFileSync(at("node_modules", "binaryen", "package.json"), "utf8")).version;
