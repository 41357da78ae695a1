/** Size budgets: of the WebAssembly modules, as they are in the built package, and of the page. */
import { readdirSync, readFileSync } from "node:fs";
import { homedir } from "node:os";
import { join, sep } from "node:path";
import { packageDir, repository } from "../lib/paths.mjs";
import { buildSite, siteDir } from "../lib/site.mjs";
import { kilobytes, sizes, wasmFile, wasmModules } from "../lib/wasm.mjs";
import { runChecks } from "./checks.mjs";

/** What the page may take, in bytes. */
const pageBudget = 60_000;

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
    [`the page's script is within ${kilobytes(pageBudget)} gzipped, without the 3D library`, checkPage],
    ["core module holds nothing of the formats", checkSeparation],
    ["modules hold no path of the machine that built them", checkPaths],
  ]);
}

/**
 * All the script that the page loads until its first result is there: its own, and the package's with its worker.
 * @param {(note: string) => void} say
 */
async function checkPage(say) {
  await buildSite();
  const assets = join(siteDir, "assets");
  const html = readFileSync(join(siteDir, "index.html"), "utf8");
  const begun = Array.from(html.matchAll(/(?:src|href)="\.\/assets\/([^"]+\.js)"/g), ([, name = ""]) => name);
  const later = readdirSync(assets).filter((name) => /^(worker|formats)-.*\.js$/.test(name));
  const parts = [...begun, ...later].map((name) => sizes(join(assets, name)).gzip);
  const sum = parts.reduce((total, part) => total + part, 0);
  const found = `${kilobytes(sum)} gzipped in ${parts.length} files`;
  if (begun.length === 0 || later.length !== 2)
    throw new Error(`The page's scripts are not where they were: ${begun}, ${later}.`);
  if (sum > pageBudget) throw new Error(`The page: ${found}. Remedy: find what grew, or load it when it is wanted.`);
  say(found);
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
