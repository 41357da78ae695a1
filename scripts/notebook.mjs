/** `npm run notebook`: executes `docs/notebook.ipynb` with the packed package, and rewrites it with its outputs. */
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { buildPackage } from "./lib/package.mjs";
import { at } from "./lib/paths.mjs";
import { pythonWith } from "./lib/python.mjs";
import { run } from "./lib/run.mjs";
import { pageSamplesDir } from "./lib/sample.mjs";
import { script, step } from "./lib/step.mjs";
import { packed } from "./suites/installed.mjs";

const notebook = at("docs", "notebook.ipynb");

await script(async () => {
  await buildPackage();
  const python = await pythonWith("notebooks");
  const { file } = await packed();
  const cwd = mkdtempSync(join(tmpdir(), "sim3align-notebook-"));
  const env = { SIM3ALIGN_PACKAGE: file, SIM3ALIGN_SAMPLES: pageSamplesDir };
  const execute = at("scripts", "bench", "notebooks", "execute.py");
  await step("docs/notebook.ipynb", () => run(python, [execute, notebook, notebook], { cwd, env })).finally(() =>
    rmSync(cwd, { recursive: true, force: true }),
  );
});
