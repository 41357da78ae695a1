/** The package in apps of every kind, without any configuration for it, in a real browser: the bits are those of Node. */
import assert from "node:assert/strict";
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { before, test } from "node:test";
import { build as esbuild } from "esbuild";
import { createAligner } from "sim3align";
import { createServer, build as vite } from "vite";
import webpack from "webpack";
import { browserFor, WEBGL } from "../support/browser.js";
import { installDir } from "../support/environment.js";
import { type Found, work } from "./work.js";

const folder = join(installDir, "apps");
const appOf = (name: string) => join(installDir, "tests", "bundlers", `${name}.js`);
const page =
  `<!doctype html><html><head><meta charset="utf-8"><link rel="icon" href="data:,"></head>` +
  `<body><script type="module" src="./main.js"></script></body></html>`;

const browser = browserFor(installDir);
const drawing = browserFor(installDir, WEBGL);
let expected: Found;
before(async () => {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  expected = await work(createAligner);
  const first = JSON.stringify(Object.values(expected)[0]);
  for (const matrix of Object.values(expected)) assert.equal(JSON.stringify(matrix), first, "workers change nothing");
});

/** Opens a page of the installation, or of another server, and holds what it shows against Node's result. */
async function check(path: string): Promise<void> {
  const { page, errors } = await browser.open(path);
  await page.waitForSelector("#outcome", { state: "attached", timeout: 120_000 });
  assert.deepEqual(JSON.parse((await page.textContent("#outcome")) ?? ""), expected);
  assert.deepEqual(errors, []);
  await page.close();
}

/** A folder for one app, with its page. */
function appFolder(name: string): string {
  const path = join(folder, name);
  mkdirSync(path, { recursive: true });
  writeFileSync(join(path, "index.html"), page);
  return path;
}

for (const name of ["app", "app-inline"]) {
  test(`Vite, built: ${name}`, async () => {
    const root = appFolder(`vite-${name}`);
    const text = readFileSync(appOf(name), "utf8")
      .replace(".wasm", ".wasm?url&inline")
      .replace("./work", appOf("work").slice(0, -3));
    writeFileSync(join(root, "main.js"), text);
    await vite({ root, base: "./", logLevel: "error", configFile: false });
    await check(`apps/vite-${name}/dist/index.html`);
  });
}

test("Vite, as its development server serves it", async () => {
  const root = appFolder("vite-dev");
  writeFileSync(join(root, "main.js"), `import ${JSON.stringify(appOf("app"))};\n`);
  const server = await createServer({
    root,
    configFile: false,
    logLevel: "error",
    server: { host: "127.0.0.1", port: 0, fs: { allow: [installDir] } },
  });
  try {
    await server.listen();
    await check(server.resolvedUrls?.local[0] ?? "");
  } finally {
    await server.close();
  }
});

for (const name of ["app", "app-inline"]) {
  test(`webpack: ${name}`, async () => {
    const path = appFolder(`webpack-${name}`);
    const stats = await new Promise<webpack.Stats | undefined>((resolve, reject) => {
      const config = {
        mode: "production",
        performance: false,
        entry: appOf(name),
        module: { rules: name === "app" ? [] : [{ test: /\.wasm$/, type: "asset/inline" }] },
        output: { path, filename: "main.js" },
      } as const;
      webpack(config, (error, result) => (error ? reject(error) : resolve(result)));
    });
    const { errors = [], warnings = [] } = stats?.toJson({ all: false, errors: true, warnings: true }) ?? {};
    assert.deepEqual([...errors, ...warnings], []);
    await check(`apps/webpack-${name}/index.html`);
  });
}

test("the element draws with the three.js of an app, which is in its bundle once", async () => {
  const copies = (text: string) => text.match(/\.isObject3D\s*=\s*(?:!0|true)/g)?.length ?? 0;
  const root = appFolder("vite-element");
  const own = readFileSync(appOf("app-element"), "utf8").replace(
    "../support/",
    join(dirname(appOf("app")), "../support/"),
  );
  const counts: number[] = [];
  // The entry with a copy of its own would show twice as many: what is counted is there.
  for (const text of [own.replaceAll("sim3align/element/shared", "sim3align/element"), own]) {
    writeFileSync(join(root, "main.js"), text);
    await vite({ root, base: "./", logLevel: "error", configFile: false });
    const assets = join(root, "dist", "assets");
    const scripts = readdirSync(assets).filter((name) => name.endsWith(".js"));
    counts.push(scripts.reduce((sum, name) => sum + copies(readFileSync(join(assets, name), "utf8")), 0));
  }
  assert.deepEqual(counts, [2, 1]);
  const { page, errors } = await drawing.open("apps/vite-element/dist/index.html");
  await page.locator("sim3-align .space[data-state=ready] canvas").first().waitFor({ timeout: 120_000 });
  assert.deepEqual(errors, []);
  await page.close();
});

test("esbuild, in one piece, as one classic script", async () => {
  const path = appFolder("esbuild");
  const { warnings } = await esbuild({
    entryPoints: [appOf("app-inline")],
    bundle: true,
    format: "iife",
    outfile: join(path, "main.js"),
    loader: { ".wasm": "binary" },
    target: "es2022",
    logLevel: "silent",
  });
  assert.deepEqual(warnings, []);
  assert.deepEqual(readdirSync(path).sort(), ["index.html", "main.js"]);
  assert.doesNotMatch(readFileSync(join(path, "main.js"), "utf8").slice(0, 100), /^import /);
  await check("apps/esbuild/index.html");
});

test("what a bundler leaves out: who wants an error's class or a file reader gets no aligner", async () => {
  const sizeOf = async (contents: string, splitting = true) => {
    const { metafile } = await esbuild({
      stdin: { contents, resolveDir: installDir },
      ...{ bundle: true, format: "esm", splitting, outdir: folder, write: false, minify: true, metafile: true },
    });
    // With what it imports at once: a bundler moves there what it shares with files that are loaded later.
    const first = new Set(Object.keys(metafile.outputs).filter((path) => path.endsWith("stdin.js")));
    for (const path of first) {
      const { imports = [] } = metafile.outputs[path] ?? {};
      for (const { kind, path } of imports) if (kind === "import-statement") first.add(path);
    }
    return first.size === 0
      ? Number.POSITIVE_INFINITY
      : [...first].reduce((sum, path) => sum + (metafile.outputs[path]?.bytes ?? 0), 0);
  };
  // In one file: where it divides files, esbuild keeps what is loaded later, also of functions that nobody calls.
  assert.ok((await sizeOf('export { Sim3AlignError } from "sim3align";', false)) < 1000);
  // Binary files are read by modules, which one the first bytes tell; those of JSON by script, each by its own.
  assert.ok((await sizeOf('export { readDepth, readMesh } from "sim3align/formats";')) < 19_500);
  assert.ok((await sizeOf('export { readCamera } from "sim3align/formats";')) < 10_000);
  assert.ok((await sizeOf('export { readMask } from "sim3align/formats";')) < 15_500);
});
