/** How the site is built from `www/`, the package in `pkg/` and the samples. */
import { existsSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const www = dirname(fileURLToPath(import.meta.url));
const repository = dirname(www);
const samples = join(repository, "target", "samples");

/** Names of the samples' files, so that the page need not ask for a list before it asks for them. */
const sampleFiles = Object.fromEntries(
  (existsSync(samples) ? readdirSync(samples) : []).map((name) => [name, readdirSync(join(samples, name)).sort()]),
);

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
  define: { SAMPLE_FILES: JSON.stringify(sampleFiles) },
  worker: { format: "es" },
  logLevel: "warn",
  build: {
    outDir: join(repository, "target", "www"),
    emptyOutDir: true,
    target: "es2022",
    // three.js is one chunk, which is loaded when everything else is there.
    chunkSizeWarningLimit: 1000,
  },
});
