/** `sim3align/inline`: the package in one piece, and the worker's script, whole, in it. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { refuseForeign } from "./notices.mjs";
import { compiledDir, packageDir } from "./paths.mjs";
import { wasmFile, wasmModules } from "./wasm.mjs";

/** Options of both bundles. A bundle has no files next to it, so that `import.meta.url` is of no use. */
const common = /** @type {const} */ ({
  bundle: true,
  platform: "neutral",
  target: "es2022",
  define: { "import.meta.url": "undefined" },
  logLevel: "warning",
  metafile: true,
});

/** Bundles the compiler's output. */
export async function bundleInline() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const base64 = Object.fromEntries(
    wasmModules.map((module) => [module.name, readFileSync(wasmFile(module)).toString("base64")]),
  );
  const worker = await build({ ...common, entryPoints: [join(compiledDir, "worker.js")], write: false, minify: true });
  refuseForeign(worker.metafile);
  const inlined = new Map([
    ["core", base64.core],
    ["worker", worker.outputFiles[0]?.text],
  ]);
  // Few callers need the other modules: they stay files of their own.
  mkdirSync(join(packageDir, "inline"), { recursive: true });
  for (const [name, module] of Object.entries(base64)) {
    // Nor is the module of `sim3align/simulators` one of this entry.
    if (name !== "core" && name !== "physics")
      writeFileSync(join(packageDir, "inline", `${name}.js`), `${exported(module)}\n`);
  }
  const { metafile } = await build({
    ...common,
    entryPoints: [join(compiledDir, "inline.js")],
    outfile: join(packageDir, "inline.js"),
    format: "esm",
    plugins: [
      {
        name: "inlined",
        setup(build) {
          build.onResolve({ filter: /^inlined:/ }, ({ path }) => {
            const name = path.slice(8);
            return inlined.has(name)
              ? { path: name, namespace: "inlined" }
              : { path: `./inline/${name}.js`, external: true };
          });
          build.onLoad({ filter: /.*/, namespace: "inlined" }, ({ path }) => ({
            contents: exported(inlined.get(path)),
          }));
        },
      },
    ],
  });
  refuseForeign(metafile);
}

/** @param {string | undefined} text */
const exported = (text) => `export default ${JSON.stringify(text)};`;
