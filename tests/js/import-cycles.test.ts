/** The package's sources: no file imports itself by way of others, not even its types. */
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { repository } from "../support/environment.js";

/** Imports between files: each file, relative to the root, with the files that it imports. */
type Imports = ReadonlyMap<string, readonly string[]>;

function importsOf(root: string): Imports {
  const files = readdirSync(root, { recursive: true, encoding: "utf8" })
    .map((file) => file.replaceAll("\\", "/"))
    .filter((file) => file.endsWith(".ts") && !file.startsWith("wasm/"));
  return new Map(
    files.map((file) => {
      const specifiers = readFileSync(join(root, file), "utf8").matchAll(/(?:from|import\()\s*"(\.[^"]+)\.js"/g);
      const imported = Array.from(specifiers, ([, path = ""]) =>
        join(dirname(file), `${path}.ts`).replaceAll("\\", "/"),
      );
      return [file, imported.filter((other) => files.includes(other))];
    }),
  );
}

/** A cycle: its files in order, the first one again at the end; `null` where there is none. */
function cycleIn(imports: Imports): string[] | null {
  const finished = new Set<string>();
  const visit = (file: string, path: readonly string[]): string[] | null => {
    if (path.includes(file)) return [...path.slice(path.indexOf(file)), file];
    if (finished.has(file)) return null;
    for (const other of imports.get(file) ?? []) {
      const cycle = visit(other, [...path, file]);
      if (cycle !== null) return cycle;
    }
    finished.add(file);
    return null;
  };
  for (const file of imports.keys()) {
    const cycle = visit(file, []);
    if (cycle !== null) return cycle;
  }
  return null;
}

test("a cycle is found", () => {
  const files = { "a.ts": ["b.ts", "c.ts"], "b.ts": ["c.ts"], "c.ts": ["d.ts"], "d.ts": ["b.ts"] };
  assert.deepEqual(cycleIn(new Map(Object.entries(files))), ["b.ts", "c.ts", "d.ts", "b.ts"]);
});

test("no imports go in a circle", () => {
  const imports = importsOf(join(repository, "pkg-config", "src"));
  assert.ok(imports.get("aligner.ts")?.includes("pool/pool.ts"), "imports are followed");
  assert.deepEqual(cycleIn(imports), null);
});
