/**
 * `node scripts/test-file.mjs tests/js/align.test.ts [--test-name-pattern=TEXT]`: some files of tests that use the package, which is
 * built where its sources have changed. `SIM3ALIGN_WINDOW=1` shows the browser.
 */
import { join, relative, resolve } from "node:path";
import { installDir, repository } from "./lib/paths.mjs";
import { chromium, firefox } from "./lib/programs.mjs";
import { run } from "./lib/run.mjs";
import { buildSite } from "./lib/site.mjs";
import { script } from "./lib/step.mjs";
import { examplesDir, install, testEnvironment } from "./suites/installed.mjs";

await script(async () => {
  const args = process.argv.slice(2).map((arg) => {
    const inside = relative(repository, resolve(arg));
    return arg.endsWith(".ts") ? join(installDir, inside.replace(/ts$/, "js")) : arg;
  });
  await install();
  if (args.some((arg) => /[\\/](browser|examples)[\\/]/.test(arg))) await buildSite();
  const programs = { CHROMIUM_PATH: await chromium(), FIREFOX_PATH: await firefox() };
  const env = { ...testEnvironment, ...programs, SIM3ALIGN_EXAMPLES: examplesDir };
  const test = ["--enable-source-maps", "--test", "--test-reporter=spec", ...args];
  await run(process.execPath, test, { cwd: installDir, env, attach: true });
});
