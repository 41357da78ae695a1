/** Builds the custom element `<sim3-align>` and its page for iframes: a folder that any host can serve. */
import { join } from "node:path";
import { defineConfig } from "vite";
import { shared } from "./vite.config.mjs";

const www = /** @type {string} */ (shared.root);

export default defineConfig({
  ...shared,
  // The element has no samples.
  define: { ...shared.define, SAMPLES: "[]" },
  build: {
    ...shared.build,
    outDir: join(/** @type {string} */ (shared.build?.outDir), "element"),
    rolldownOptions: {
      input: { "sim3-align": join(www, "src", "element", "index.ts"), frame: join(www, "frame.html") },
      preserveEntrySignatures: "strict",
      // Hosts name the script, so its name is always the same.
      output: { entryFileNames: ({ name }) => (name === "sim3-align" ? "[name].js" : "assets/[name]-[hash].js") },
    },
  },
});
