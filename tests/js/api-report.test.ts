/** The report of the exported types: what it lists, and what it leaves out. */
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, test } from "node:test";
import { installDir } from "../support/environment.js";
import { scriptModule } from "../support/internals.js";

const { apiReport } = await scriptModule("lib/api-report.mjs");

const folder = mkdtempSync(join(tmpdir(), "sim3align-api-"));
after(() => rmSync(folder, { recursive: true, force: true }));

const files: Record<string, string> = {
  "package.json": JSON.stringify({ exports: { ".": { types: "./index.d.ts" }, "./package.json": "./package.json" } }),
  "index.d.ts": `/** The entry. */
export { create as make, type Options } from "./parts/create.js";
export * from "./all.js";
`,
  "all.d.ts": "export declare const LIMIT = 3;\n",
  "parts/create.d.ts": `import type { Mesh } from "../mesh.js";
import type { Worker } from "node:worker_threads";
/** Words about the options. */
export interface Options {
    /** Words about the mesh. */
    mesh?: Mesh;
    worker: Worker;
}
interface Unused {
    a: 1;
}
export declare function create(): Options;
export declare function create(options: Options): Own;
type Own = {
    own: Options;
};
export {};
`,
  "mesh.d.ts": "export interface Mesh {\n    positions: Float32Array;\n}\nexport interface Other {\n}\n",
};

/** The report of these files, of which one may differ. */
function reportOf(changed: Record<string, string> = {}): string {
  for (const [path, text] of Object.entries({ ...files, ...changed })) {
    mkdirSync(dirname(join(folder, path)), { recursive: true });
    writeFileSync(join(folder, path), text);
  }
  return apiReport(folder);
}

test("the report has the names of each entry, and all that they refer to, without comments", () => {
  const [, ...lines] = reportOf().split("\n\n");
  assert.equal(
    lines.join("\n\n"),
    `entry .
  LIMIT
  Options
  make

export declare const LIMIT = 3;

export interface Mesh {
    positions: Float32Array;
}

export interface Options {
    mesh?: Mesh;
    worker: Worker;
}

type Own = {
    own: Options;
};

export declare function create(): Options;
export declare function create(options: Options): Own;
`,
  );
});

test("changes of types that are referred to show; comments, other types and the files of types do not", () => {
  const before = reportOf();
  const mesh = files["mesh.d.ts"] ?? "";
  assert.notEqual(reportOf({ "mesh.d.ts": mesh.replace("Float32Array", "Float64Array") }), before);
  assert.equal(reportOf({ "mesh.d.ts": mesh.replace("Other {", "Other {\n    more: string;") }), before);
  assert.equal(reportOf({ "mesh.d.ts": `/** Words. */\n${mesh}` }), before);
  assert.equal(reportOf({ "mesh.d.ts": 'export type { Mesh } from "./moved.js";\n', "moved.d.ts": mesh }), before);
  assert.notEqual(reportOf({ "all.d.ts": "export declare const LIMIT = 4;\n" }), before);
});

test("of a whole file that is imported under one name, only what is referred to is in the report", () => {
  const report = reportOf({
    "all.d.ts": 'import type * as All from "./mesh.js";\nexport declare const LIMIT: All.Other;\n',
    "mesh.d.ts": "export interface Other {\n}\nexport interface Third {\n}\nexport interface Mesh {\n}\n",
  });
  assert.ok(report.includes("interface Other"));
  assert.ok(!report.includes("interface Third"));
});

test("a statement that is not understood is an error, not a gap", () => {
  assert.throws(() => reportOf({ "all.d.ts": 'export * as all from "./mesh.js";\n' }), /is not understood/);
});

test("the report of the package, whose declarations are bundled, has its methods, options and errors", () => {
  const report = apiReport(join(installDir, "node_modules", "sim3align"));
  for (const text of [
    "alignScene(scene: SceneInput",
    "interface AlignOptions",
    "type ErrorCode =",
    "entry ./three",
    "declare global",
  ]) {
    assert.ok(report.includes(text), text);
  }
});
