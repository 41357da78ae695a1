/** `sim3align/inline`: the package in one piece, and the worker's script, whole, in it. */
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { packageDir } from "./paths.mjs";
import { wasmFile, wasmModules } from "./wasm.mjs";

/** Options of both bundles. A bundle has no files next to it, so that `import.meta.url` is of no use. */
const common = /** @type {const} */ ({
  bundle: true,
  platform: "neutral",
  target: "es2022",
  define: { "import.meta.url": "undefined" },
  logLevel: "warning",
});

/** Bundles the compiler's output in pkg/. */
export async function bundleInline() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const base64 = Object.fromEntries(
    wasmModules.map((module) => [module.name, readFileSync(wasmFile(module)).toString("base64")]),
  );
  const worker = await build({ ...common, entryPoints: [join(packageDir, "worker.js")], write: false, minify: true });
  const inlined = new Map([
    ["core", base64.core],
    ["worker", worker.outputFiles[0]?.text],
  ]);
  // Few callers need the formats module: it stays a file of its own.
  const formats = "inline/formats.js";
  mkdirSync(join(packageDir, "inline"), { recursive: true });
  writeFileSync(join(packageDir, formats), `${exported(base64.formats)}\n`);
  rmSync(join(packageDir, "inlined.d.ts"), { force: true });
  await build({
    ...common,
    entryPoints: [join(packageDir, "inline.js")],
    outfile: join(packageDir, "inline.js"),
    allowOverwrite: true,
    format: "esm",
    plugins: [
      {
        name: "inlined",
        setup(build) {
          build.onResolve({ filter: /^inlined:formats$/ }, () => ({ path: `./${formats}`, external: true }));
          build.onResolve({ filter: /^inlined:/ }, ({ path }) => ({ path: path.slice(8), namespace: "inlined" }));
          build.onLoad({ filter: /.*/, namespace: "inlined" }, ({ path }) => ({
            contents: exported(inlined.get(path)),
          }));
        },
      },
    ],
  });
}

/** @param {string | undefined} text */
const exported = (text) => `export default ${JSON.stringify(text)};`;
