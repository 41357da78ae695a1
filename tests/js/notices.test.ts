/** The licences of the code in the package. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { repository } from "../support/environment.js";
import { scriptModule } from "../support/internals.js";

const { takenOf, refuseForeign } = await scriptModule("lib/notices.mjs");

test("of alternatives, an allowed licence is taken; of several that hold together, all have to be", () => {
  for (const [expression, taken] of [
    ["MIT", ["MIT"]],
    ["Apache-2.0 OR MIT", ["MIT"]],
    ["MIT/Apache-2.0", ["MIT"]],
    ["GPL-3.0-only OR Zlib", ["Zlib"]],
    ["(MIT OR Apache-2.0) AND Unicode-3.0", ["MIT", "Unicode-3.0"]],
    ["Apache-2.0 AND (GPL-2.0 OR (ISC AND MIT))", ["Apache-2.0", "ISC", "MIT"]],
    ["GPL-3.0-only", undefined],
    ["MIT AND LGPL-3.0", undefined],
    ["", undefined],
  ] as const) {
    assert.deepEqual(takenOf(expression), taken, expression);
  }
});

test("a bundle with an npm package is refused", () => {
  refuseForeign({ inputs: { "pkg/worker.js": {} } });
  assert.throws(() => refuseForeign({ inputs: { "node_modules/three/build/three.js": {} } }), /holds .*three/);
});

test("the package carries the notice, and it names what the physics module links, with its text", () => {
  const installed = dirname(fileURLToPath(import.meta.resolve("sim3align")));
  const text = readFileSync(join(installed, "THIRD-PARTY.txt"), "utf8");
  assert.equal(text, readFileSync(join(repository, "THIRD-PARTY.txt"), "utf8"));
  assert.match(text, /^parry3d \d\S+ +Apache-2\.0$/m);
  const texts = text.split(/^-{80}\n(?=.*\n-{80}\n)/m).slice(1);
  const named = new Set(texts.flatMap((each) => (each.split("\n")[0] ?? "").split(", ")));
  const listed = [...text.matchAll(/^(\S+ \d\S+) +(?:MIT|Apache-2\.0|Zlib|BSD-[23]-Clause)\b.*$/gm)].map(
    ([, name = ""]) => name.trim(),
  );
  assert.ok(listed.length > 40);
  assert.deepEqual([...named].sort(), [...listed].sort());
  assert.ok(texts.find((each) => each.startsWith("parry3d") || each.includes(", parry3d"))?.includes("Apache License"));
});
