import { defineConfig } from "vite";

export default defineConfig({
  // Serves the case folders unchanged.
  publicDir: "../sample",
  // The package locates its worker and its WebAssembly relative to its modules, so Vite before version 8 must not move these.
  optimizeDeps: { exclude: ["sim3align"] },
  worker: { format: "es" },
  build: { target: "es2022", chunkSizeWarningLimit: 1000 },
});
