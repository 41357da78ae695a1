/** The set-up: installs what a machine with only rustup and Node lacks. */
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { cached, digest, once } from "./cache.mjs";
import { at, toolsDir } from "./paths.mjs";
import { attempt, run } from "./run.mjs";
import { step } from "./step.mjs";

export const wasmTarget = "wasm32-unknown-unknown";

/** The npm packages of package-lock.json. */
export const npmPackages = once(() =>
  step("npm packages", async (say) => {
    const major = Number(process.versions.node.split(".")[0]);
    if (major < 20) throw new Error(`Node ${process.version} is too old. Remedy: install Node 20 or newer.`);
    const inputs = digest([at("package.json"), at("package-lock.json")]);
    const installed = await cached(at("node_modules", ".installed-from"), inputs, [], async () => {
      await run("npm", ["ci", "--no-audit", "--no-fund"], {
        remedy: "check that the npm registry can be reached, and that package.json and package-lock.json agree",
      });
    });
    say(installed ? "installed" : "up to date");
  }),
);

/** The toolchain of rust-toolchain.toml, with its components and the WebAssembly target. */
export const rustToolchain = once(() =>
  step("Rust toolchain", async (say) => {
    const { stdout } = await attempt("rustc", ["--print", "sysroot"]);
    const parts = [
      ["lib", "rustlib", wasmTarget],
      ...["cargo-clippy", "rustfmt"].map((name) => ["bin", program(name)]),
    ];
    if (!stdout || !parts.every((path) => existsSync(join(stdout.trim(), ...path)))) {
      await run("rustup", ["toolchain", "install"], {
        remedy: "install rustup (https://rustup.rs), and check that its server can be reached",
      });
    }
    say((await run("rustc", ["--version"])).trim());
  }),
);

/** The version in Cargo.lock: wasm-bindgen's program has to be of exactly the crate's version. */
export function wasmBindgenVersion() {
  const version = /name = "wasm-bindgen"\r?\nversion = "([^"]+)"/.exec(readFileSync(at("Cargo.lock"), "utf8"))?.[1];
  if (!version) throw new Error("Cargo.lock does not name wasm-bindgen. Remedy: restore Cargo.lock.");
  return version;
}

/** @param {string} name */
const program = (name) => (process.platform === "win32" ? `${name}.exe` : name);

/** The program of scripts/bindgen. */
export const bindgenProgram = join(toolsDir, "debug", program("sim3align-bindgen"));

/** Compiles wasm-bindgen. */
export const wasmBindgen = once(async () => {
  await rustToolchain();
  const manifest = at("scripts", "bindgen", "Cargo.toml");
  await step("wasm-bindgen", () =>
    run("cargo", ["build", "--quiet", "--locked", "--manifest-path", manifest, "--target-dir", toolsDir], {
      remedy: "check that the Rust package registry can be reached",
    }),
  );
});

/** Installs everything that a build needs. */
export const setUp = once(async () => {
  await Promise.all([npmPackages(), wasmBindgen()]);
});
