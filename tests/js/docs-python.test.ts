/** The Python of the guides: a notebook's cell that runs the command line, the executed notebook, and Rerun. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { chmodSync, mkdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { delimiter, dirname, join } from "node:path";
import { test } from "node:test";
import { files, folder, read, writeCase } from "../support/command-line.js";
import { commandLine, installDir, repository } from "../support/environment.js";

const python = process.env.SIM3ALIGN_NOTEBOOKS ?? "";
const skip = python === "" && "No Python with the packages of scripts/bench/notebooks/requirements.txt.";

const guide = readFileSync(join(repository, "docs", "guides", "batches.md"), "utf8");
const blocks = [...guide.matchAll(/^```python\n([\s\S]*?)^```$/gm)]
  .map(([, block = ""]) => block)
  .filter((block) => !block.includes("class Aligner"));

/** Runs a program of the environment in a folder. `npx sim3align` is the package under test. */
function runIn(cwd: string, program: string, ...args: string[]): string {
  const bin = join(folder, "bin");
  mkdirSync(bin, { recursive: true });
  writeFileSync(join(bin, "npx"), `#!/bin/sh\nshift\nexec "${process.execPath}" "${commandLine}" "$@"\n`);
  chmodSync(join(bin, "npx"), 0o755);
  const { dependencies } = JSON.parse(readFileSync(join(installDir, "package.json"), "utf8"));
  const env = {
    ...process.env,
    PATH: [bin, process.env.PATH].join(delimiter),
    SIM3ALIGN_PACKAGE: dependencies.sim3align.replace(/^file:/, ""),
  };
  const { status, stdout, stderr } = spawnSync(program, args, { cwd, env, encoding: "utf8" });
  assert.equal(status, 0, stderr);
  return stdout;
}

type Text = string | string[];
/** A notebook, as far as these tests read it. */
interface Notebook {
  cells: { outputs?: { text?: Text; data?: Record<string, Text> }[] }[];
}

/** Executes a notebook. */
function executed(source: object, at: string): Notebook {
  const [given, made] = [join(at, "given.ipynb"), join(at, "executed.ipynb")];
  writeFileSync(given, JSON.stringify(source));
  runIn(at, python, join(repository, "scripts", "bench", "notebooks", "execute.py"), given, made);
  return JSON.parse(readFileSync(made, "utf8"));
}

const joined = (text: Text = "") => (Array.isArray(text) ? text.join("") : text);
const outputsOf = ({ cells }: Notebook) => cells.flatMap(({ outputs = [] }) => outputs);
/** The text output of a notebook's cells, and the pictures that they show. */
const textsOf = (book: Notebook) =>
  outputsOf(book).flatMap(({ text, data }) => [joined(text), joined(data?.["text/markdown"])].filter(Boolean));
const picturesOf = (book: Notebook) => outputsOf(book).flatMap(({ data }) => joined(data?.["image/png"]) || []);

test("a cell of a notebook runs the command line, and prints the result of each case", { skip }, () => {
  writeCase("cases/blob", files);
  writeCase("cases/broken", { ...files, "mesh.glb": new Uint8Array(3) });
  // Run twice: the second time, everything is there.
  const cells = ["a", "b"].map((id) => ({
    ...{ cell_type: "code", id, source: blocks[0], metadata: {}, outputs: [], execution_count: null },
  }));
  const made = executed({ nbformat: 4, nbformat_minor: 5, metadata: {}, cells }, folder);
  const lines = textsOf(made).join("").trim().split("\n").sort();
  const record = read("results.jsonl")
    .trim()
    .split("\n")
    .slice(1)
    .map((line) => JSON.parse(line));
  const [result, failed] = record.sort((a, b) => (a.case < b.case ? -1 : 1));
  const aligned = `blob confidence ${result.confidence.toFixed(2)}, scale ${result.scale.toFixed(4)}`;
  const broken = `broken ${failed.error.code}`;
  assert.deepEqual([record.length, lines], [2, [aligned, aligned, broken, broken]]);
});

test("docs/notebook.ipynb ends without an error, with the table and the pictures that are stored in it", {
  skip,
}, () => {
  const path = join(repository, "docs", "notebook.ipynb");
  assert.ok(statSync(path).size < 300_000, "the notebook is small");
  const stored: Notebook = JSON.parse(readFileSync(path, "utf8"));
  // A folder of its own, into which the notebook installs the tarball that this folder was installed from.
  const home = join(folder, "notebook");
  mkdirSync(home);
  const made = executed(stored, home);
  assert.ok(textsOf(made).some((text) => text.startsWith("| case | confidence |")));
  assert.deepEqual(textsOf(made), textsOf(stored), "execute it anew where the results are meant to differ");
  assert.equal(picturesOf(made).length, 2);
  assert.deepEqual(picturesOf(made), picturesOf(stored));
});

test("Rerun shows the record: camera, depth and mesh", { skip }, () => {
  writeFileSync(join(folder, "show.py"), blocks[1] ?? assert.fail("the guide has no second block of Python"));
  runIn(folder, python, "show.py");
  const rerun = join(dirname(python), "rerun");
  runIn(folder, rerun, "rrd", "verify", "results.rrd");
  const printed = runIn(folder, rerun, "rrd", "print", "-vvv", "results.rrd");
  for (const entity of ["/blob/camera", "/blob/camera/depth", "/blob/mesh", "/blob/confidence"]) {
    assert.ok(printed.includes(entity), `${entity} is there`);
  }
  assert.ok(!printed.includes("/broken"), "what failed is left out");
});
