/**
 * `npm run build`, `build:www`, `docs`, `api-report`, `notices`, `samples` and `format`: each writes one thing. Those that are
 * committed are checked by `npm test`.
 */
import { writeApiDocs } from "./lib/api-docs.mjs";
import { writeApiReport } from "./lib/api-report.mjs";
import { writeNotice } from "./lib/notices.mjs";
import { buildPackage } from "./lib/package.mjs";
import { nodeProgram, run } from "./lib/run.mjs";
import { generateSamples, pageSamplesDir } from "./lib/sample.mjs";
import { npmPackages, rustToolchain } from "./lib/setup.mjs";
import { buildSite } from "./lib/site.mjs";
import { script, step } from "./lib/step.mjs";
import { buildWasm } from "./lib/wasm.mjs";

/** What can be made, each after what it needs. @type {Record<string, () => Promise<unknown>>} */
const makers = {
  /** The publishable package, in pkg/. */
  build: buildPackage,
  /** The static site, in target/www. */
  "build:www": buildSite,
  /** The API reference, in target/docs. */
  docs: () => buildWasm().then(() => step("API reference", writeApiDocs)),
  /** The report of the package's API; to be committed. */
  "api-report": () => buildPackage().then(() => step("API report", writeApiReport)),
  /** The licences of the code in the package; to be committed. */
  notices: () => rustToolchain().then(() => step("third-party notices", writeNotice)),
  /** The page's samples; to be committed. */
  samples: () => rustToolchain().then(() => step("samples", () => generateSamples(pageSamplesDir))),
  /** Everything, formatted, with the linter's safe corrections. */
  async format() {
    await Promise.all([npmPackages(), rustToolchain()]);
    await step("Rust", () => run("cargo", ["fmt", "--all"]));
    const [node, biome] = nodeProgram("@biomejs/biome", "biome");
    await step("everything else", () => run(node, [biome, "check", "--write", "--error-on-warnings"]));
  },
};

await script(async () => {
  const [name = ""] = process.argv.slice(2);
  const make = makers[name];
  if (make === undefined) throw new Error(`Found ${name || "nothing"}, expected one of ${Object.keys(makers).join()}.`);
  await make();
});
