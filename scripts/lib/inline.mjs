/** `sim3align/inline`: the package in one piece, and the worker's script, whole, in it. */
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { build } from "esbuild";
import { packageDir } from "./paths.mjs";
import { wasmFile, wasmModules } from "./wasm.mjs";

/** What both bundles have in common. Nothing in them is beside anything: addresses have no base. */
const common = /** @type {const} */ ({
  bundle: true,
  platform: "neutral",
  target: "es2022",
  define: { "import.meta.url": "undefined" },
  logLevel: "warning",
});

/** Bundles what the compiler has written to pkg/, which keeps everything else as it is. */
export async function bundleInline() {
  const worker = await build({ ...common, entryPoints: [join(packageDir, "worker.js")], write: false, minify: true });
  /** @type {Map<string, string>} */
  const inlined = new Map([["worker", worker.outputFiles[0]?.text ?? ""]]);
  for (const module of wasmModules) inlined.set(module.name, readFileSync(wasmFile(module)).toString("base64"));
  rmSync(join(packageDir, "inlined.d.ts"), { force: true });
  await build({
    ...common,
    entryPoints: [join(packageDir, "inline.js")],
    outdir: packageDir,
    allowOverwrite: true,
    format: "esm",
    splitting: true,
    chunkNames: "inline/[name]-[hash]",
    plugins: [
      {
        name: "inlined",
        setup(build) {
          build.onResolve({ filter: /^inlined:/ }, ({ path }) => ({ path: path.slice(8), namespace: "inlined" }));
          build.onLoad({ filter: /.*/, namespace: "inlined" }, ({ path }) => ({
            contents: `export default ${JSON.stringify(inlined.get(path))};`,
          }));
        },
      },
    ],
  });
}
