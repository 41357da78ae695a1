import { defineConfig } from "vite";

export default defineConfig({
  // Serves the case folder unchanged.
  publicDir: "../sample",
  // The package locates its worker and its WebAssembly relative to its modules, so Vite must not move these.
  optimizeDeps: { exclude: ["sim3align"] },
  oxc: { jsx: { runtime: "automatic" } },
  worker: { format: "es" },
  build: { target: "es2022", chunkSizeWarningLimit: 1500 },
});
