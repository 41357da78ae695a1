/** Builds the site from `www/`, the package in `pkg/` and the samples. */
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { defineConfig } from "vite";
import { definitions } from "./definitions.mjs";
import { documentation, documents } from "./documentation.mjs";
import { serviceWorker } from "./service-worker.mjs";

const www = dirname(fileURLToPath(import.meta.url));
const repository = dirname(www);
const samples = join(www, "samples", "index.json");

const guides = documents(repository);
const manifest = JSON.parse(readFileSync(join(repository, "pkg-config", "package.json"), "utf8"));

// Modules, not bundles: the page also uses some that the package does not export.
const compiled = join(repository, "target", "compiled");
const { OPTIONS } = await import(pathToFileURL(join(compiled, "index.js")).href);

/** Scripts that are loaded when they are needed. */
const later =
  /\/src\/(intake|masking|session|export|view3d)\/|\/src\/(alignment\/(advice|video|known-size)|input\/(allowance|archives|names|slices|video-frames)|state\/object-work|commands\/nudges|opening\/case-url|pictures\/(albedo|evidence|pose-thumbnail|thumbnails)|views\/space|ui\/(metric-texts|number-input)|panels\/(advised|after-result|export-panel|scene-list|storage-warnings|time-panel|help-dialog|alternatives|hand-panel|numbers|known-size|options-panel|remedies|details|input-rows))\./;

/** Whether the page loads a module at first. @param {string} id */
const isFirst = (id) => (id.startsWith(join(www, "src")) || id.includes("/preact/")) && !later.test(id);

/** Modules of WebAssembly, and scripts, that the first alignment loads one after the other. */
const first =
  /(core|formats)_bg[^/]*\.wasm$|^assets\/(formats|camera-file|compressed-gltf|own-decoders|meshopt)-[^/]*\.js$/;

/**
 * Preloads what the first alignment needs, so that it is downloaded in parallel with the script.
 * @type {import("vite").Plugin}
 */
const preloads = {
  name: "preloads",
  transformIndexHtml: {
    order: "post",
    handler: (_, { bundle = {} }) =>
      Object.keys(bundle)
        .filter((name) => first.test(name))
        .map((name) => ({
          tag: "link",
          attrs: name.endsWith(".js")
            ? { rel: "modulepreload", href: `./${name}` }
            : { rel: "preload", as: "fetch", href: `./${name}`, crossorigin: true },
          injectTo: "head",
        })),
  },
};

export default defineConfig({
  root: www,
  // The site works from any path.
  base: "./",
  publicDir: false,
  resolve: {
    alias: [
      // The readers of files refer to this one as well, but the page does not use it at first: a module of its own.
      { find: /^sim3align\/scene\/sam3d-files$/, replacement: join(compiled, "scene", "sam3d-files.js?intake") },
      { find: /^sim3align$/, replacement: join(compiled, "index.js") },
      { find: /^sim3align\/(.+)$/, replacement: join(compiled, "$1.js") },
    ],
  },
  define: {
    ...definitions(OPTIONS, existsSync(samples) ? readFileSync(samples, "utf8") : undefined),
    SOURCE: JSON.stringify(manifest.homepage.replace(/#.*/, "")),
    DOCUMENTS: JSON.stringify(guides.listed.map(({ title, fileName }) => [title, fileName])),
  },
  // What workers load later has names of its own.
  worker: { format: "es", rolldownOptions: { output: { chunkFileNames: "assets/in-worker-[name]-[hash].js" } } },
  logLevel: "warn",
  plugins: [preloads, documentation(www, guides), serviceWorker(www)],
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
    // What the page loads at first is one chunk: it compresses better than the parts that others share with it.
    rolldownOptions: { output: { codeSplitting: { groups: [{ name: "page", test: isFirst }] } } },
  },
});
