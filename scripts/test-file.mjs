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
  const args = process.argv.slice(2);
  const named = args.filter((arg) => arg.endsWith(".ts")).map((arg) => relative(repository, resolve(arg)));
  const files = named.map((file) => join(installDir, file.replace(/ts$/, "js")));
  // Node takes what follows the first file for another one.
  const options = args.filter((arg) => !arg.endsWith(".ts"));
  await install();
  if (named.some((file) => /[\\/](browser|examples)[\\/]/.test(file))) await buildSite();
  const programs = { CHROMIUM_PATH: await chromium(), FIREFOX_PATH: await firefox() };
  const env = { ...testEnvironment, ...programs, SIM3ALIGN_EXAMPLES: examplesDir };
  const test = ["--enable-source-maps", "--test", "--test-reporter=spec", ...options, ...files];
  await run(process.execPath, test, { cwd: installDir, env, attach: true });
});
