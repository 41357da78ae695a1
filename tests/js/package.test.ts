import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { commandLine } from "../support/environment.js";

const require = createRequire(import.meta.url);
const readJson = (specifier: string) => JSON.parse(readFileSync(require.resolve(specifier), "utf8"));
const manifest = readJson("sim3align/package.json");

for (const name of ["core", "formats"]) {
  test(`the ${name} module can be named by bundlers and is WebAssembly`, () => {
    const bytes = readFileSync(require.resolve(`sim3align/wasm/${name}_bg.wasm`));
    assert.ok(WebAssembly.validate(bytes));
  });
}

test("what is not exported stays private", () => {
  assert.throws(() => require.resolve("sim3align/cli.js"), { code: "ERR_PACKAGE_PATH_NOT_EXPORTED" });
});

test("the command line says the package's version", () => {
  const output = execFileSync(process.execPath, [commandLine, "--version"], { encoding: "utf8" });
  assert.equal(output.trim(), manifest.version);
});

test("the command line explains itself", () => {
  const output = execFileSync(process.execPath, [commandLine, "--help"], { encoding: "utf8" });
  assert.match(output, /^Usage: sim3align /);
  assert.match(output, /\balign\b/);
});
