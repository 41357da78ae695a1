/** Real cases, where SIM3ALIGN_CASES names a folder of them. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { commandLine } from "../support/environment.js";

const cases = process.env.SIM3ALIGN_CASES;
const skip = cases === undefined ? "SIM3ALIGN_CASES is not set" : false;
const folders = readdirSync(cases ?? ".", { withFileTypes: true })
  .filter((entry) => entry.isDirectory() && existsSync(join(cases ?? ".", entry.name, "camera.json")))
  .map(({ name }) => join(cases ?? ".", name));

/** The entry of a case in the JSON, as far as it is tested here. */
interface CaseResult {
  metrics: { iou: number };
  diagnostics: { scaleRatio: number; collapsed: boolean };
  [name: string]: unknown;
}

/** Runs the command line, and returns the JSON that it wrote. */
function run(...args: string[]): Record<string, CaseResult> {
  const folder = mkdtempSync(join(tmpdir(), "sim3align-real-"));
  try {
    const json = join(folder, "out.json");
    const { status, stdout, stderr } = spawnSync(process.execPath, [commandLine, ...args, "--json", json], {
      encoding: "utf8",
    });
    assert.equal(status, 0, stdout + stderr);
    console.log(stdout);
    return JSON.parse(readFileSync(json, "utf8"));
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

test("every case aligns, and no scale leaves the guard", { skip }, () => {
  assert.ok(folders.length > 0, `no case in ${cases}`);
  const results = Object.entries(run("align", ...folders, "--preset", "paper"));
  assert.equal(results.length, folders.length);
  for (const [name, { diagnostics, metrics }] of results) {
    const { scaleRatio, collapsed } = diagnostics;
    assert.ok(scaleRatio >= 0.5 - 1e-9 && scaleRatio <= 1.5 + 1e-9, `${name}: ${scaleRatio}`);
    assert.equal(collapsed, false, name);
    assert.ok(metrics.iou >= 0 && metrics.iou <= 1, name);
  }
});

for (const folder of cases === undefined ? [] : folders) {
  const { available } = JSON.parse(readFileSync(join(folder, "gt.json"), "utf8")) as { available: boolean };
  test(`the truth of ${folder.split("/").pop()} scores well`, {
    skip: available ? false : "its pose is not known",
  }, () => {
    const [{ metrics, errors }] = Object.values(run("evaluate", folder)) as unknown as [
      { metrics: { iou: number; normalConsistency: number }; errors: { rotationErrorDeg: number } },
    ];
    assert.ok(metrics.iou >= 0.92, `iou ${metrics.iou}`);
    assert.ok(metrics.normalConsistency > 0.75, `normalConsistency ${metrics.normalConsistency}`);
    assert.ok(errors.rotationErrorDeg < 1e-3);
  });
}
