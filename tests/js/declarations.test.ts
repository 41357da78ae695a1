/** The package's declarations, in projects as its users have them. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { installDir, repository } from "../support/environment.js";

const tsc = join(repository, "node_modules", "typescript", "bin", "tsc");

/** What the compiler says about a project with one file, declarations of the package included. */
function compiled(file: string, source: string, options: object): string {
  const folder = mkdtempSync(join(installDir, "declarations-"));
  writeFileSync(join(folder, file), source);
  const compilerOptions = { strict: true, noEmit: true, skipLibCheck: false, target: "es2022", ...options };
  writeFileSync(join(folder, "tsconfig.json"), JSON.stringify({ compilerOptions, files: [file] }));
  return spawnSync(process.execPath, [tsc, "--project", folder], { encoding: "utf8" }).stdout;
}

const node = { lib: ["es2022"], types: ["node"], module: "nodenext" };

const allEntries = `
  import { createAligner, type AlignInput } from "sim3align";
  import { createAligner as createInline } from "sim3align/inline";
  import { readCase } from "sim3align/formats";
  import { toSim3 } from "sim3align/conventions";
  import { applyPinhole } from "sim3align/three";
  export async function run(input: AlignInput) {
    const aligner = await createAligner({ wasm: { core: new Uint8Array(8) }, workers: 1 });
    void [createInline, readCase, toSim3, applyPinhole];
    return aligner.align(input, { signal: AbortSignal.timeout(1000) });
  }
`;

test("every entry compiles in a Node project without the DOM library", () => {
  assert.equal(compiled("app.mts", allEntries, node), "");
});

test("every entry compiles in a browser's project without Node's types", () => {
  const browser = { lib: ["es2022", "esnext.disposable", "dom"], types: [], module: "esnext" };
  assert.equal(compiled("app.mts", allEntries, { ...browser, moduleResolution: "bundler" }), "");
});

test("every entry compiles without the DOM library and without Node's types", () => {
  const alone = allEntries.replace(", { signal: AbortSignal.timeout(1000) }", "");
  assert.equal(compiled("app.mts", alone, { lib: ["es2022"], types: [], module: "nodenext" }), "");
});

test("a mistake is seen in these projects", () => {
  const wrong = `import { createAligner } from "sim3align"; createAligner({ workers: "many" });`;
  assert.match(compiled("app.mts", wrong, node), /TS2322/);
});

for (const [form, source] of Object.entries({
  import: `import { createAligner } from "sim3align"; export const aligner = createAligner();`,
  require: `import sim3align = require("sim3align"); export const aligner = sim3align.createAligner();`,
})) {
  test(`CommonJS, by ${form}: compiles with "module": "nodenext"`, () => {
    assert.equal(compiled("app.cts", source, node), "");
  });
}
