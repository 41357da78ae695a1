/** How the site is built from `www/`, the package in `pkg/` and the samples. */
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const www = dirname(fileURLToPath(import.meta.url));
const repository = dirname(www);
/** The samples, listed in the script, so that the page need not ask for the list before it asks for them. */
const samples = join(www, "samples", "index.json");

export default defineConfig({
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
  define: { SAMPLES: existsSync(samples) ? readFileSync(samples, "utf8") : "[]" },
  worker: { format: "es" },
  logLevel: "warn",
  build: {
    outDir: join(repository, "target", "www"),
    emptyOutDir: true,
    target: "es2022",
    // All of these know light-dark(), which the theme's switch needs as it is.
    cssTarget: ["chrome123", "firefox120", "safari17.5"],
    // three.js is one chunk, which is loaded when everything else is there.
    chunkSizeWarningLimit: 1000,
  },
});
