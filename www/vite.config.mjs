/** Builds the site from `www/`, the package in `pkg/` and the samples. */
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { defineConfig } from "vite";

const www = dirname(fileURLToPath(import.meta.url));
const repository = dirname(www);
/** The list of samples. As part of the script, it saves the page a request before those of the samples. */
const samples = join(www, "samples", "index.json");

/** The option table of the package. The script gets only the rows and fields that the page uses. */
const { OPTIONS } = await import(pathToFileURL(join(repository, "pkg", "index.js")).href);
const rowOf = (name) => OPTIONS.align.find((row) => row.name === name);
const optionTable = {
  quality: rowOf("quality").choices,
  maxSeed: rowOf("seed").max,
};

/** Scripts that are loaded when they are needed. */
const later =
  /\/src\/(intake|session|export|view3d)\/|\/src\/(run\/(video|known-size)|load\/(allowance|archives|case-url|label-masks|slices)|draw\/(albedo|pose-thumbnail|thumbnails)|views\/space|panels\/(time-panel|help-dialog|alternatives|late|hand-panel|numbers|known-size|options-panel|remedies|details|input-rows))\./;

/** Whether the page loads a module at first. @param {string} id */
const isFirst = (id) => (id.startsWith(join(www, "src")) || id.includes("/preact/")) && !later.test(id);

/**
 * The modules that the first alignment needs are downloaded beside the script, not after it.
 * @type {import("vite").Plugin}
 */
const preloadedModules = {
  name: "preloaded-modules",
  transformIndexHtml: {
    order: "post",
    handler: (_, { bundle = {} }) =>
      Object.keys(bundle)
        .filter((name) => /(core|formats)_bg[^/]*\.wasm$/.test(name))
        .map((name) => ({
          tag: "link",
          attrs: { rel: "preload", as: "fetch", href: `./${name}`, crossorigin: true },
          injectTo: "head",
        })),
  },
};

/** What the page and the element have in common. @type {import("vite").UserConfig} */
export const shared = {
  root: www,
  // The site works from any path.
  base: "./",
  publicDir: false,
  resolve: {
    alias: [
      { find: /^sim3align$/, replacement: join(repository, "pkg", "index.js") },
      { find: /^sim3align\/(.+)$/, replacement: join(repository, "pkg", "$1.js") },
    ],
  },
  define: {
    SAMPLES: existsSync(samples) ? readFileSync(samples, "utf8") : "[]",
    OPTION_TABLE: JSON.stringify(optionTable),
  },
  // What workers load later has names of its own.
  worker: { format: "es", rolldownOptions: { output: { chunkFileNames: "assets/in-worker-[name]-[hash].js" } } },
  logLevel: "warn",
  build: {
    outDir: join(repository, "target", "www"),
    emptyOutDir: true,
    target: "es2022",
    // The supported browsers implement modulepreload.
    modulePreload: { polyfill: false },
    // These browsers support light-dark(), which the theme switch needs untransformed.
    cssTarget: ["chrome123", "firefox120", "safari17.5"],
    // three.js is one chunk, which the page loads last.
    chunkSizeWarningLimit: 1000,
  },
};

export default defineConfig({
  ...shared,
  plugins: [preloadedModules],
  build: {
    ...shared.build,
    // What the page loads at first is one chunk: it compresses better than the parts that others share with it.
    rolldownOptions: { output: { codeSplitting: { groups: [{ name: "page", test: isFirst }] } } },
  },
});
