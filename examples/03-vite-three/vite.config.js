import { defineConfig } from "vite";

export default defineConfig({
  // Case folders, served as they are.
  publicDir: "../sample",
  // The worker and the WebAssembly are found by their place beside the package's scripts, so these stay where they are.
  optimizeDeps: { exclude: ["sim3align"] },
  worker: { format: "es" },
  build: { target: "es2022", chunkSizeWarningLimit: 1000 },
});
