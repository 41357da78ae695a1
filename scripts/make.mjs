/** `npm run build`, `build:www`, `docs`, `update` and `format`: each writes one thing. `npm test` checks those that are committed. */
import { writeApiDocs } from "./lib/api-docs.mjs";
import { writeApiReport } from "./lib/api-report.mjs";
import { writeNotice } from "./lib/notices.mjs";
import { buildPackage } from "./lib/package.mjs";
import { nodeProgram, run } from "./lib/run.mjs";
import { npmPackages, rustToolchain } from "./lib/setup.mjs";
import { buildSite } from "./lib/site.mjs";
import { script, step } from "./lib/step.mjs";
import { buildWasm } from "./lib/wasm.mjs";
import { writeFigures } from "./record/documents.mjs";

/** @type {Record<string, () => Promise<unknown>>} */
const makers = {
  /** The publishable package, in pkg/. */
  build: buildPackage,
  /** The static site, in target/www. */
  "build:www": buildSite,
  /** The API reference, in target/docs. */
  docs: () => buildWasm().then(() => step("API reference", writeApiDocs)),
  /** The committed files that follow from the sources: declarations of the options, figures of the record, the API report, the notices. */
  async update() {
    await rustToolchain();
    const declarations = ["test", "--quiet", "--workspace", "--test", "lab", "typescript"];
    await step("TypeScript declarations", () => run("cargo", declarations, { env: { UPDATE: "1" } }));
    await npmPackages();
    await step("figures of the record", writeFigures);
    await buildPackage();
    await step("API report", writeApiReport);
    await step("third-party notices", writeNotice);
  },
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
