/** The package's scripts and declarations, bundled by entry: what several entries share is in parts beside them. */
import { chmodSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, normalize, relative, sep } from "node:path";
import { refuseForeign } from "./notices.mjs";
import { compiledDir, glueDir, packageDir, skinDir } from "./paths.mjs";
import { wasmModules } from "./wasm.mjs";

/** Chunks that several entries share: beside them, so that the same paths lead to the modules. */
const PART = "part-[hash]";

/** The names of the files in package.json that end in this way. @param {string} extension */
function named(extension) {
  const { bin, exports } = JSON.parse(readFileSync(join(skinDir, "package.json"), "utf8"));
  const paths = [bin, ...Object.values(exports)].flatMap((target) => Object.values(target));
  return paths.filter((path) => path.endsWith(extension)).map((path) => normalize(path.slice(0, -extension.length)));
}

/** Entries whose scripts are bundled in ways of their own. */
const apart = ["inline", ...["sim3-align", "single", "shared"].map((name) => join("element", name))];

/**
 * Files that are named relative to a script, as seen from another place.
 * @param {string} text of the script
 * @param {string} from its path
 * @param {(file: string) => string} toPlace
 */
export const withAddresses = (text, from, toPlace) =>
  text.replaceAll(
    /new URL\(["']([^"']+)["'](?=, (String\()?import\.meta\.url)/g,
    (_, file) => `new URL(${JSON.stringify(toPlace(join(dirname(from), file)))}`,
  );

/**
 * A path below {@link compiledDir} as seen from a folder of the package.
 * @param {string} folder
 * @param {string} file
 */
export function fromFolder(folder, file) {
  const path = relative(join(compiledDir, folder), file).split(sep).join("/");
  return path.startsWith("../") ? path : `./${path}`;
}

/**
 * Writes minified scripts, with the comments by which bundlers leave imports of Node's modules alone: esbuild drops them.
 * @param {readonly { path: string, text: string }[]} files
 */
export function writeMinified(files) {
  for (const { path, text } of files) {
    mkdirSync(dirname(path), { recursive: true });
    const ignored = "import(/* webpackIgnore: true */ /* @vite-ignore */ ";
    writeFileSync(path, text.replaceAll(/\bimport\((?=[\w$]+\))/g, ignored));
  }
}

/** Minifies the glue of the modules. */
export async function bundleGlue() {
  // The set-up installs it first.
  const { transform } = await import("esbuild");
  for (const { name } of wasmModules) {
    const { code } = await transform(readFileSync(join(glueDir, `${name}.js`), "utf8"), { minify: true });
    writeFileSync(join(packageDir, "wasm", `${name}.js`), code);
  }
}

/** Bundles and minifies the compiler's scripts. The glue of the modules stays beside them. */
export async function bundleScripts() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const names = named(".js").filter((name) => !apart.includes(name));
  const { metafile, outputFiles } = await build({
    entryPoints: names.map((name) => join(compiledDir, `${name}.js`)),
    outdir: packageDir,
    outbase: compiledDir,
    ...{ bundle: true, splitting: true, format: "esm", platform: "neutral", target: "es2022", logLevel: "warning" },
    ...{ minify: true, write: false },
    chunkNames: PART,
    external: ["node:*", "commander"],
    metafile: true,
    plugins: [
      {
        name: "own-files",
        setup(build) {
          build.onResolve({ filter: /\/wasm\/[\w-]+\.js$/ }, ({ path, resolveDir }) => ({
            path: fromFolder("", join(resolveDir, path)),
            external: true,
          }));
          build.onLoad({ filter: /\.js$/ }, ({ path }) => {
            const folder = path.startsWith(join(compiledDir, "cli", sep)) ? "cli" : "";
            const toPlace = (/** @type {string} */ file) => fromFolder(folder, file);
            return { contents: withAddresses(readFileSync(path, "utf8"), path, toPlace) };
          });
        },
      },
    ],
  });
  refuseForeign(metafile);
  writeMinified(outputFiles);
  chmodSync(join(packageDir, "cli", "main.js"), 0o755);
}

/** Bundles the compiler's declarations. */
export async function bundleTypes() {
  // The set-up installs them first.
  const { rollup } = await import("rollup");
  const { dts } = await import("rollup-plugin-dts");
  const names = named(".d.ts");
  const bundle = await rollup({
    input: Object.fromEntries(names.map((name) => [name, join(compiledDir, `${name}.d.ts`)])),
    plugins: [dts()],
    external: [/^node:/, "three"],
    onLog: (_, { code, message }) => {
      // The worker exports nothing. Types of parts are reached by the properties that have them; what compilers write about
      // these into the declarations of users, tests/js/inferred.test-d.ts shows.
      if (code !== "EMPTY_BUNDLE" && !/private shared type exports/.test(message)) throw new Error(message);
    },
  });
  await bundle.write({
    dir: packageDir,
    entryFileNames: "[name].d.ts",
    chunkFileNames: `${PART}.d.ts`,
    banner: ({ moduleIds }) => references(moduleIds),
  });
  await bundle.close();
}

/** The references of declarations to libraries of the compiler, which a bundle would lose. @param {string[]} files */
function references(files) {
  const found = files.flatMap((file) => readFileSync(file, "utf8").match(/^\/\/\/ <reference lib=.*$/gm) ?? []);
  return [...new Set(found)].join("\n");
}
