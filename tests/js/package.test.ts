import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { commandLine } from "../support/environment.js";

const require = createRequire(import.meta.url);
const readJson = (specifier: string) => JSON.parse(readFileSync(require.resolve(specifier), "utf8"));
const manifest = readJson("sim3align/package.json");

for (const name of ["core", "depth-files", "formats", "joint", "physics", "registration", "splats"]) {
  test(`the ${name} module can be named by bundlers and is WebAssembly`, () => {
    const bytes = readFileSync(require.resolve(`sim3align/wasm/${name}_bg.wasm`));
    assert.ok(WebAssembly.validate(bytes));
  });
}

/** The scripts of the package that an entry loads, itself included, and what it imports from elsewhere. */
function importsOf(entry: string): { own: string[]; foreign: string[] } {
  const own = [require.resolve(entry)];
  const foreign: string[] = [];
  for (const file of own) {
    for (const [, specifier = ""] of readFileSync(file, "utf8").matchAll(
      /^(?:import|export)\b[^;]*?from "([^"]+)"/gm,
    )) {
      const imported = join(dirname(file), specifier);
      if (!specifier.startsWith(".")) foreign.push(specifier);
      else if (!own.includes(imported)) own.push(imported);
    }
  }
  return { own: own.map((file) => readFileSync(file, "utf8")), foreign };
}

test("the main entry loads nothing of the conventions", () => {
  const { own, foreign } = importsOf("sim3align");
  assert.ok(!own.some((script) => /\b(toCvatCuboid|placeSplats|meshInputFromThree)\b/.test(script)));
  assert.deepEqual(foreign, []);
  assert.ok(
    own.some((script) => script.includes("beginAlign")),
    "imports are followed",
  );
});

test("the conventions load no WebAssembly, and three.js' no three.js", () => {
  for (const entry of ["sim3align/conventions", "sim3align/three"]) {
    const { own, foreign } = importsOf(entry);
    assert.ok(!own.some((script) => /WebAssembly\.|_bg\.wasm|beginAlign/.test(script)), entry);
    assert.deepEqual(foreign, [], entry);
    assert.ok(
      own.some((script) => script.includes("determinant = (m)")),
      "imports are followed",
    );
  }
});

test("what is not exported stays private", () => {
  assert.throws(() => require.resolve("sim3align/cli/main.js"), { code: "ERR_PACKAGE_PATH_NOT_EXPORTED" });
});

test("the command line says the package's version", () => {
  const output = execFileSync(process.execPath, [commandLine, "--version"], { encoding: "utf8" });
  assert.equal(output.trim(), manifest.version);
});
