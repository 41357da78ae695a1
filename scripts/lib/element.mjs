/** `sim3align/element`: the custom element and its page for iframes, in one folder, which uses the WebAssembly of the package around it. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { pathToFileURL } from "node:url";
import { definitions } from "../../www/definitions.mjs";
import { fromFolder, withAddresses } from "./bundle.mjs";
import { allowBundled } from "./notices.mjs";
import { at, compiledDir, packageDir } from "./paths.mjs";

const sources = at("www", "src");
const folder = join(packageDir, "element");
/** The entries of the element. */
const entries = {
  "sim3-align": join(sources, "element", "index.ts"),
  shared: join(sources, "element", "shared.ts"),
};
/** What the 3D view uses of three.js. */
const threeFile = join(sources, "view3d", "three.ts");

/** Leaves three.js in the file that the split build makes of it. */
const threeBeside = /** @type {import("esbuild").Plugin} */ ({
  name: "three-beside",
  setup(build) {
    build.onResolve({ filter: /\/three\.js$/ }, ({ importer }) =>
      importer === entries["sim3-align"] ? { path: "./three.js", external: true } : undefined,
    );
  },
});

/**
 * The package's files, style sheets as texts, and addresses of files beside the bundle instead of beside their source.
 * @param {(name: string) => string} scriptOf the script of a worker
 * @returns {import("esbuild").Plugin}
 */
const ownFiles = (scriptOf) => ({
  name: "own-files",
  setup(build) {
    build.onResolve({ filter: /^sim3align(\/|$)/ }, ({ path }) => ({ path: join(compiledDir, ownModule(path)) }));
    // The view gets three.js from its source when it runs: only the two entries of the element import it.
    build.onResolve({ filter: /\/three\.js$/ }, ({ importer, path, resolveDir }) => {
      const file = join(resolveDir, path.replace(/js$/, "ts"));
      if (file !== threeFile || importer === entries["sim3-align"]) return undefined;
      return { path: file, namespace: importer === entries.shared ? "three-of-app" : "three-names" };
    });
    build.onLoad({ filter: /./, namespace: "three-of-app" }, () => ({
      contents: readFileSync(threeFile, "utf8"),
      loader: "ts",
    }));
    build.onLoad({ filter: /./, namespace: "three-names" }, () => {
      const lists = readFileSync(threeFile, "utf8").matchAll(/^export \{([^}]*)\}/gm);
      const names = Array.from(lists, ([, list = ""]) => list.replace(/,\s*$/, ""));
      const contents = `import { three } from "./three-source.js"; export const { ${names.join(", ")} } = three();`;
      return { contents, resolveDir: dirname(threeFile) };
    });
    build.onResolve({ filter: /^three(\/|$)/, namespace: "three-of-app" }, ({ path }) => ({ path, external: true }));
    // Addons of three.js import from "three", whose WebGL renderer would be in the bundle beside that of "three/webgpu".
    build.onResolve({ filter: /^three$/ }, ({ kind, resolveDir }) =>
      build.resolve("three/webgpu", { kind, resolveDir }),
    );
    build.onResolve({ filter: /\.css\?inline$/ }, ({ path, resolveDir }) => ({
      path: join(resolveDir, path.replace("?inline", "")),
    }));
    build.onLoad({ filter: /\.css$/ }, async ({ path }) => {
      const { transform } = await import("esbuild");
      const { code } = await transform(readFileSync(path, "utf8"), { loader: "css", minify: true });
      return { contents: code, loader: "text" };
    });
    build.onLoad({ filter: /\.[jt]s$/ }, ({ path }) => {
      const text = readFileSync(path, "utf8");
      if (path.includes("node_modules")) return undefined;
      // Browsers lack the modules of Node, and bundlers would warn of these imports.
      const ofBrowsers = text.replaceAll(/import\(\s*\/\* webpackIgnore: true \*\/[^)]*\)/g, "Promise.reject()");
      const contents = withAddresses(ofBrowsers, path, (file) => fromBundle(file, scriptOf));
      return { contents, loader: path.endsWith(".ts") ? "ts" : "js" };
    });
  },
});

/** @param {string} specifier such as `sim3align/formats` */
const ownModule = (specifier) => `${specifier.slice("sim3align/".length) || "index"}.js`;

/**
 * A file as seen from the bundle, which has the scripts of workers.
 * @param {string} file
 * @param {(name: string) => string} scriptOf the script of a worker
 */
function fromBundle(file, scriptOf) {
  const isWorker = /worker\.[jt]s$/.test(file);
  if (isWorker) return `./${scriptOf(basename(file).replace(/ts$/, "js"))}`;
  return fromFolder("element", file);
}

/** Bundles `www/src/element` against the compiler's output. */
export async function bundleElement() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const { OPTIONS } = await import(pathToFileURL(join(packageDir, "index.js")).href);
  /** @type {import("esbuild").BuildOptions} */
  const common = {
    outdir: folder,
    ...{ bundle: true, minify: true, format: "esm", platform: "browser", target: "es2022" },
    ...{ jsx: "automatic", jsxImportSource: "preact", logLevel: "warning", legalComments: "none" },
    define: definitions(OPTIONS),
  };
  const { metafile } = await build({
    ...common,
    entryPoints: {
      ...entries,
      three: threeFile,
      frame: join(sources, "element", "frame.ts"),
      "reader-worker": join(sources, "input", "reader-worker.ts"),
      worker: join(compiledDir, "worker.js"),
    },
    // Parts that the first alignment does not need are files of their own.
    ...{ splitting: true, chunkNames: "part-[hash]", metafile: true },
    plugins: [ownFiles((name) => name)],
  });
  // For hosts that would rather load one script than many small ones; it is that of the workers, too.
  const entryPoints = { single: join(sources, "element", "single.ts") };
  await build({ ...common, entryPoints, plugins: [threeBeside, ownFiles(() => "single.js")] });
  allowBundled(metafile);
  const page = readFileSync(at("www", "frame.html"), "utf8");
  writeFileSync(join(folder, "frame.html"), page.replace("./src/element/frame.ts", "./frame.js"));
  const declarations = join(sources, "element", "sim3-align.d.ts");
  const text = readFileSync(declarations, "utf8").replaceAll(
    /(?<=from ")sim3align(\/\w+)?(?=")/g,
    (specifier) => `../${ownModule(specifier)}`,
  );
  mkdirSync(join(compiledDir, "element"));
  writeFileSync(join(compiledDir, "element", basename(declarations)), text);
}
