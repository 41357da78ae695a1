/** The package as it is packed and installed. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { test } from "node:test";

const require = createRequire(import.meta.url);

test("what an entry imports is in the package: no three.js, and no other package", () => {
  for (const entry of ["sim3align", "sim3align/conventions", "sim3align/three", "sim3align/formats"]) {
    const loaded = new Set([require.resolve(entry)]);
    for (const file of loaded) {
      // Whatever their spaces: scripts are minified.
      const imports = /(?:^|[;}])(?:import|export)\b(?:[^;"()]*\bfrom)?\s*"([^"]+)"/gm;
      for (const [, name = ""] of readFileSync(file, "utf8").matchAll(imports)) {
        assert.match(name, /^\.{1,2}\//, file);
        loaded.add(join(dirname(file), name));
      }
    }
    assert.ok(loaded.size > 1, entry);
  }
});

test("what is not exported stays private", () => {
  assert.throws(() => require.resolve("sim3align/cli/main.js"), { code: "ERR_PACKAGE_PATH_NOT_EXPORTED" });
});
