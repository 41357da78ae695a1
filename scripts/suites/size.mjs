/** Size budgets of the WebAssembly modules, as they are in the built package. */
import { readFileSync } from "node:fs";
import { homedir } from "node:os";
import { join, sep } from "node:path";
import { packageDir, repository } from "../lib/paths.mjs";
import { kilobytes, sizes, wasmFile, wasmModules } from "../lib/wasm.mjs";
import { runChecks } from "./checks.mjs";

const packaged = join(packageDir, "wasm");

/**
 * What a module exports to its callers, without what wasm-bindgen adds for itself.
 * @param {string} file
 */
function exportsOf(file) {
  return WebAssembly.Module.exports(new WebAssembly.Module(readFileSync(file)))
    .map(({ name }) => name)
    .filter((name) => !name.startsWith("__") && name !== "memory");
}

export function checkSizes() {
  return runChecks([
    ...wasmModules.map(
      (module) =>
        /** @type {const} */ ([
          `${module.name} module is within ${kilobytes(module.budget)} gzipped`,
          (/** @type {(note: string) => void} */ say) => {
            const { raw, gzip } = sizes(wasmFile(module, packaged));
            const found = `${kilobytes(gzip)} gzipped, ${kilobytes(raw)} as it is`;
            if (gzip > module.budget) throw new Error(`${module.name}: ${found}. Remedy: find what grew (twiggy).`);
            say(found);
          },
        ]),
    ),
    ["core module holds nothing of the formats", checkSeparation],
    ["modules hold no path of the machine that built them", checkPaths],
  ]);
}

function checkSeparation() {
  const [core = [], formats = []] = wasmModules.map((module) => exportsOf(wasmFile(module, packaged)));
  const shared = formats.filter((name) => core.includes(name));
  if (core.length === 0 || formats.length === 0)
    throw new Error("A module exports nothing: are its bindings compiled?");
  if (shared.length > 0) throw new Error(`Both modules export ${shared.join(", ")}. Remedy: export each from one.`);
}

function checkPaths() {
  for (const module of wasmModules) {
    const bytes = readFileSync(wasmFile(module, packaged));
    for (const path of [homedir(), repository]) {
      if (bytes.includes(`${path}${sep}`)) throw new Error(`${module.name} holds ${path}. Remedy: see rustFlags().`);
    }
  }
}
