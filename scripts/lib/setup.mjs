/** The set-up: what a machine with only rustup and Node lacks, installed when it is missing. */
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { at, toolsDir } from "./paths.mjs";
import { attempt, run } from "./run.mjs";
import { digest, Stamp } from "./stamp.mjs";
import { step } from "./step.mjs";

export const wasmTarget = "wasm32-unknown-unknown";

/** Everything that a build needs. */
export async function setUp() {
  checkNode();
  await step("npm packages", installPackages);
  await step("Rust toolchain", installToolchain);
  await step("wasm-bindgen", installWasmBindgen);
}

function checkNode() {
  const major = Number(process.versions.node.split(".")[0]);
  if (major < 20) throw new Error(`Node ${process.version} is too old. Remedy: install Node 20 or newer.`);
}

/** @param {(note: string) => void} say */
async function installPackages(say) {
  const inputs = digest([at("package.json"), at("package-lock.json")]);
  const stamp = new Stamp(at("node_modules", ".installed-from"), inputs, []);
  if (stamp.isCurrent) return say("up to date");
  await run("npm", ["ci", "--no-audit", "--no-fund"], {
    remedy: "check that the npm registry can be reached, and that package.json and package-lock.json agree",
  });
  stamp.write();
  say("installed");
}

/** @param {(note: string) => void} say */
async function installToolchain(say) {
  const rustup = async (/** @type {string[]} */ ...args) =>
    run("rustup", args, { remedy: "install rustup (https://rustup.rs), and check that its server can be reached" });

  let found = await attempt("rustc", ["--version"]);
  if (found.reason) {
    // Installs what rust-toolchain.toml names.
    await rustup("toolchain", "install");
    found = { ...found, output: await run("rustc", ["--version"]) };
  }
  const added = [];
  const sysroot = (await run("rustc", ["--print", "sysroot"])).trim();
  if (!existsSync(join(sysroot, "lib", "rustlib", wasmTarget))) {
    await rustup("target", "add", wasmTarget);
    added.push(wasmTarget);
  }
  for (const component of ["clippy", "rustfmt"]) {
    const program = component === "clippy" ? "cargo-clippy" : "rustfmt";
    if ((await attempt(program, ["--version"])).reason) {
      await rustup("component", "add", component);
      added.push(component);
    }
  }
  const version = found.output.trim().split("\n").at(-1) ?? "";
  say([version, ...added.map((part) => `added ${part}`)].join(", "));
}

/** The version that Cargo.lock holds: the program must be of exactly the crate's version. */
export function wasmBindgenVersion() {
  const lock = readFileSync(at("Cargo.lock"), "utf8");
  const version = /name = "wasm-bindgen"\r?\nversion = "([^"]+)"/.exec(lock)?.[1];
  if (!version) throw new Error("Cargo.lock does not name wasm-bindgen. Remedy: restore Cargo.lock.");
  return version;
}

/**
 * A program of wasm-bindgen's.
 * @param {"wasm-bindgen" | "wasm-bindgen-test-runner"} name
 */
export const wasmBindgenProgram = (name) => join(toolsDir, "bin", process.platform === "win32" ? `${name}.exe` : name);

/** @param {(note: string) => void} say */
async function installWasmBindgen(say) {
  const version = wasmBindgenVersion();
  const found = await attempt(wasmBindgenProgram("wasm-bindgen"), ["--version"]);
  const runner = existsSync(wasmBindgenProgram("wasm-bindgen-test-runner"));
  if (runner && found.output.trim().endsWith(` ${version}`)) return say(`${version}, up to date`);
  // Unoptimised: it compiles in a quarter of the time, and on modules of this size runs equally fast.
  const args = ["--config", "profile.dev.opt-level=0", "--config", "profile.dev.debug=false"];
  args.push("install", "wasm-bindgen-cli", "--version", version, "--debug", "--force", "--root", toolsDir);
  args.push("--bin", "wasm-bindgen", "--bin", "wasm-bindgen-test-runner");
  await run("cargo", args, {
    // Without a target folder of its own, cargo compiles in a temporary one and removes it.
    env: { CARGO_TARGET_DIR: undefined },
    remedy: "check that the Rust package registry can be reached",
  });
  say(`${version}, installed`);
}
