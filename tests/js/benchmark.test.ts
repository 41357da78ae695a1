/** The benchmark's own arithmetic: what rows say of their cases, which rows there are, what is printed and drawn. */
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { scriptModule } from "../support/internals.js";

const script = (name: string) => scriptModule(`bench/${name}`);
const [{ summarise, summariseTruth, columns }, { tableSpecs, rowsToRun }, { makeTables, tableMarkdown }] =
  await Promise.all(["summary", "rows", "tables"].map((name) => script(`paper/${name}.mjs`)));
const [{ byDifficulty, byOverlap, figurePage }, { openResults }, { readRecords }] = await Promise.all(
  ["paper/figures.mjs", "results.mjs", "records.mjs"].map(script),
);

const metrics = { boundaryF: 0.8, centerDriftPx: 4, iou: 0.6, chamferMm: 10, uniChamferMm: 5 };
const all = { ...metrics, fitness: 0.9, normalConsistency: 0.7, depthMaeMm: 8 };
const right = { scaleError: 0.01, rotationErrorDeg: 2, translationErrorRelative: 0.01 };
const diagnostics = { score: 1, collapsed: false, clamped: false };
const alignment = { matrix: [], confidence: 1, diagnostics };

function record(changes: object = {}) {
  const posed = { ...alignment, metrics: all };
  const shared = { name: "case", tier: "easy", parameters: { difficulty: 0.1 }, truthMetrics: all, truthScore: 1 };
  return { ...shared, alignment: posed, errors: right, seconds: 0.5, ...changes };
}

const unanswered = record({ alignment: null, errors: null });
const aside = record({
  alignment: {
    ...alignment,
    metrics: { ...all, iou: 0, depthMaeMm: null, centerDriftPx: null },
    diagnostics: { ...diagnostics, collapsed: true },
  },
  errors: { ...right, rotationErrorDeg: 90 },
});

test("no answer and no overlap count nothing in shares, and flatter no distance", () => {
  const { metrics: of, n, answered, success, errors, collapsed, clamped } = summarise([record(), unanswered, aside]);
  assert.deepEqual([n, answered], [3, 2]);
  assert.deepEqual(of.iou, { mean: 0.6 / 3, median: 0, n: 3 });
  assert.deepEqual(of.fitness, { mean: 1.8 / 3, median: 0.9, n: 3 });
  assert.deepEqual(of.depthMaeMm, { mean: 8, median: 8, n: 1 });
  assert.deepEqual(of.chamferMm, { mean: 10, median: 10, n: 2 });
  assert.deepEqual(success, { strict: 1 / 3, loose: 1 / 3 });
  assert.equal(errors.rotationDeg, 90);
  assert.deepEqual([collapsed, clamped], [0.5, 0]);
});

test("without a known truth there is no success, and no error", () => {
  const { success, errors } = summarise([record({ truthMetrics: null, errors: null })]);
  assert.deepEqual([success.strict, errors.scale], [null, null]);
  assert.equal(summarise([unanswered, unanswered]).errors.scale, null);
  assert.equal(summariseTruth([record({ alignment: null })]).metrics.iou.mean, 0.6);
});

test("the columns are the paper's, in its order", () => {
  assert.deepEqual(
    columns.map(({ key }: { key: string }) => key),
    ["boundaryF", "centerDriftPx", "iou", "chamferMm", "uniChamferMm", "fitness", "normalConsistency", "depthMaeMm"],
  );
});

test("the guard's ablation has eight rows, all different, and every row runs once a prior", () => {
  const specs = tableSpecs(["peer"], ["detailed", "smooth"]);
  const guard = specs.find(({ id }: { id: string }) => id === "guard");
  assert.equal(new Set(guard.rows.map(({ assignments }: { assignments: string }) => assignments)).size, 8);
  for (const prior of ["detailed", "smooth"]) {
    const names = rowsToRun(specs, prior).map(({ name }: { name: string }) => name);
    assert.equal(new Set(names).size, names.length);
    assert.ok(names.includes("precise") && !names.includes("peer"));
  }
  const voxels = specs.find(({ id }: { id: string }) => id === "voxel").rows;
  assert.deepEqual(
    voxels.map(({ assignments }: { assignments: string }) => /voxelDivisions=(\d+)/.exec(assignments)?.[1]),
    ["20", "30", "50"],
  );
  // Of one kind of mesh there is nothing to swap.
  assert.ok(tableSpecs([], ["given"]).every(({ id }: { id: string }) => id !== "prior"));
});

test("tables hold what was run, the truth, and the paper's figures below their row", () => {
  const specs = tableSpecs(["peer"], ["detailed"]);
  const records = (_: string, row: string) => (["precise", "peer"].includes(row) ? [record(), unanswered] : []);
  const paper = { main: { precise: { iou: 0.75, collapsed: 0 } } };
  const [main] = makeTables(specs, records, paper);
  assert.deepEqual(
    main.rows.map(({ name }: { name: string }) => name),
    ["precise", "peer", "(the true pose)"],
  );
  const lines = tableMarkdown(main, { "detailed/precise": 0.25 }).split("\n");
  const cells = (first: string) =>
    lines
      .find((line: string) => line.startsWith(`| ${first} `))
      ?.split("|")
      .map((cell: string) => cell.trim());
  assert.equal(cells("precise")?.[4], "0.300 (0.300)");
  assert.deepEqual(cells("precise")?.slice(-3), ["0.25", "1 of 2", ""]);
  assert.equal(cells("precise (paper)")?.[4], "0.750");
  assert.equal(cells("(the true pose)")?.[4], "0.600 (0.600)");
  assert.deepEqual(cells("(the true pose)")?.slice(9, 11), ["8.0 (8.0)", "–"]);
});

test("figures sort cases into bins of difficulty and overlap", () => {
  const hard = record({ parameters: { difficulty: 1 }, errors: null, alignment: null });
  const series = [{ method: "a", records: [record(), aside, hard] }];
  assert.deepEqual(
    byDifficulty(series).map(({ n, success, rotationDeg }: Record<string, number>) => [n, success, rotationDeg]),
    [
      [2, 50, 46],
      [1, 0, 180],
    ],
  );
  const overlap = byOverlap(series).map(({ percent }: { percent: number }) => Math.round(percent));
  assert.deepEqual(overlap, [67, 0, 0, 0, 0, 0, 33, 0, 0, 0]);
});

test("the figure page is one SVG with its pictures inside", async () => {
  const picture = { title: "a < b & c", png: Buffer.from([1, 2, 3]), width: 30, height: 20 };
  const page = await figurePage([{ method: "method", records: [record(), aside] }], [picture]);
  assert.match(page, /^<svg [^>]*viewBox="0 0 [\d.]+ [\d.]+"/);
  assert.ok(page.includes("a &lt; b &amp; c") && page.includes("data:image/png;base64,AQID"));
  assert.ok(page.includes(">method<") && page.includes("difficulty of the case"));
  assert.ok(!/NaN|undefined/.test(page));
});

test("results are gone on with where inputs and code are the same, and never mixed with others", () => {
  const folder = mkdtempSync(join(tmpdir(), "sim3align-results-"));
  try {
    openResults(folder, { code: "1", setSeed: 0 }, false);
    const file = join(folder, "records", "detailed.jsonl");
    const line = (row: string, name: string) => JSON.stringify({ row, options: "", case: name, record: record() });
    writeFileSync(file, `${[line("a", "2"), line("b", "1"), line("a", "1")].join("\n")}\n`);
    openResults(folder, { code: "1", setSeed: 0 }, false);
    const rows = readRecords(file);
    assert.deepEqual([...rows.keys()], ["a", "b"]);
    assert.deepEqual(
      rows.get("a").map(({ name }: { name: string }) => name),
      ["1", "2"],
    );
    assert.throws(() => openResults(folder, { code: "2", setSeed: 0 }, false), /--fresh/);
    openResults(folder, { code: "2", setSeed: 0 }, true);
    assert.equal(readRecords(file).size, 0);
  } finally {
    rmSync(folder, { recursive: true });
  }
});
