/** `sim3align/inline`: the package in one piece, and the worker's script, whole, in it. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { writeMinified } from "./bundle.mjs";
import { refuseForeign } from "./notices.mjs";
import { compiledDir, packageDir } from "./paths.mjs";
import { wasmFile, wasmModules } from "./wasm.mjs";

/** Leaves the decoders of compressed geometry out: without them, the bundles are a fifth smaller. */
const withoutDecoders = /** @type {import("esbuild").Plugin} */ ({
  name: "without-decoders",
  setup(build) {
    build.onLoad({ filter: /own-decoders\.js$/ }, () => ({ contents: "export const ownDecoders = () => ({});" }));
    const asItIs = "export const geometryDecoder = () => (...file) => file;";
    build.onLoad({ filter: /compressed-gltf\.js$/ }, () => ({ contents: asItIs }));
  },
});

/** Options of both bundles. A bundle has no files next to it, so that `import.meta.url` is of no use. */
const common = /** @type {const} */ ({
  bundle: true,
  platform: "neutral",
  target: "es2022",
  minify: true,
  write: false,
  define: { "import.meta.url": "undefined" },
  logLevel: "warning",
  metafile: true,
});

/** Bundles the compiler's output. */
export async function bundleInline() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const worker = await build({ ...common, plugins: [withoutDecoders], entryPoints: [join(compiledDir, "worker.js")] });
  refuseForeign(worker.metafile);
  const inlined = new Map([
    ["core", embedded("core")],
    ["worker", worker.outputFiles[0]?.text],
  ]);
  // Callers with arrays do without the readers: they stay a file of their own.
  mkdirSync(join(packageDir, "inline"), { recursive: true });
  writeFileSync(join(packageDir, "inline", "formats.js"), `${exported(embedded("formats"))}\n`);
  const { metafile, outputFiles } = await build({
    ...common,
    entryPoints: [join(compiledDir, "inline.js")],
    outfile: join(packageDir, "inline.js"),
    format: "esm",
    plugins: [
      withoutDecoders,
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
  writeMinified(outputFiles);
}

/** A module as text: gzipped, base64. @param {string} name */
function embedded(name) {
  const module = wasmModules.find((module) => module.name === name);
  if (module === undefined) throw new Error(`There is no ${name} module.`);
  return gzipSync(readFileSync(wasmFile(module)), { level: 9 }).toString("base64");
}

/** @param {string | undefined} text */
const exported = (text) => `export default ${JSON.stringify(text)};`;
