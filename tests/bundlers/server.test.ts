/** The package in bundled servers: one piece works, and what lacks its files names that remedy. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { build as esbuild } from "esbuild";
import { build as vite } from "vite";
import { installDir } from "../support/environment.js";

const folder = join(installDir, "servers");

/** A program that prints the result of a call with a file argument; `query` makes the bundler embed a module. */
const program = (entry: string, workers: number, query = "") => `
  import { createAligner } from ${JSON.stringify(entry)};
  import registration from "sim3align/wasm/registration_bg.wasm${query}";
  async function main() {
    const aligner = await createAligner({ workers: ${workers}, wasm: { registration } });
    const points = Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1);
    const { scale } = await aligner.estimateSim3(points, points.map((x) => 2 * x), Uint32Array.of(0, 0, 1, 1, 2, 2, 3, 3));
    const input = { depth: new Uint8Array(3), mask: new Uint8Array(3), camera: { fovYDeg: 50 }, mesh: new Uint8Array(3) };
    const { code } = await aligner.align(input).catch((error) => error);
    aligner.dispose();
    return [scale.toFixed(3), code].join();
  }
  main().then(console.log, (error) => console.log(error.code, error.message));
`;

before(() => {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
});

const run = (file: string) => execFileSync(process.execPath, [file], { encoding: "utf8", cwd: folder }).trim();

async function bundled(name: string, entry: string, format: "esm" | "cjs", workers: number): Promise<string> {
  const outfile = join(folder, `${name}-${workers}.${format === "esm" ? "mjs" : "cjs"}`);
  await esbuild({
    stdin: { contents: program(entry, workers), resolveDir: installDir },
    ...{
      bundle: true,
      platform: "node",
      format,
      outfile,
      logLevel: "error",
      loader: { ".wasm": "binary" },
      target: "es2022",
    },
    // esbuild warns that a CommonJS script has no import.meta.url; the test expects what comes of it.
    logOverride: { "empty-import-meta": "silent" },
  });
  return run(outfile);
}

async function builtByVite(name: string, entry: string): Promise<string> {
  const root = join(folder, name);
  mkdirSync(root, { recursive: true });
  writeFileSync(join(root, "server.mjs"), program(entry, 0, "?url&inline"));
  await vite({ root, configFile: false, logLevel: "error", ssr: { noExternal: true }, build: { ssr: "server.mjs" } });
  const script = readdirSync(join(root, "dist")).find((name) => name.startsWith("server."));
  return run(join(root, "dist", script ?? ""));
}

const remedy = /^NOT_INITIALISED wasm\.core: .*import from "sim3align\/inline"/;

const works = /^2\.000,UNSUPPORTED_FORMAT$/;

for (const format of ["esm", "cjs"] as const) {
  test(`esbuild --platform=node --format=${format}: one piece works, else the error names the remedy`, async () => {
    assert.match(await bundled("plain", "sim3align", format, 0), remedy);
    for (const workers of [0, 1]) assert.match(await bundled("inline", "sim3align/inline", format, workers), works);
  });
}

test("Vite with ssr.noExternal: one piece works, else the error names the remedy", async () => {
  assert.match(await builtByVite("vite-plain", "sim3align"), remedy);
  assert.match(await builtByVite("vite-inline", "sim3align/inline"), works);
});
