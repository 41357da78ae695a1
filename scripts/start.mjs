/** `npm start`: builds everything, and aligns the sample. */
import { join } from "node:path";
import { buildPackage } from "./lib/package.mjs";
import { packageDir } from "./lib/paths.mjs";
import { run } from "./lib/run.mjs";
import { makeSample, sampleDir } from "./lib/sample.mjs";
import { setUp } from "./lib/setup.mjs";
import { script } from "./lib/step.mjs";

await script(async () => {
  await setUp();
  await buildPackage();
  await makeSample();
  console.log();
  await run(process.execPath, [join(packageDir, "cli.js"), "align", sampleDir], { attach: true });
});
