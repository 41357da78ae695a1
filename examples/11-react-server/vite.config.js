import { defineConfig } from "vite";

export default defineConfig({
  // Serves the case folder unchanged.
  publicDir: "../sample",
  oxc: { jsx: { runtime: "automatic" } },
  worker: { format: "es" },
  build: { target: "es2022" },
});
