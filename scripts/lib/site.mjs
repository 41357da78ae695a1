/** The static site: `www/` with the built package and the samples. */
import { cpSync } from "node:fs";
import { join } from "node:path";
import { documents } from "../../www/documentation.mjs";
import { cached, digest, once } from "./cache.mjs";
import { buildPackage } from "./package.mjs";
import { at, compiledDir, repository, siteDir } from "./paths.mjs";
import { nodeProgram, run } from "./run.mjs";
import { step } from "./step.mjs";

/** Builds the package, and the site unless nothing of it has changed. */
export const buildSite = once(async () => {
  await buildPackage();
  await step("site", async (say) => {
    const inputs = digest([
      at("www"),
      at("docs"),
      ...documents(repository).all.map(({ path }) => path),
      at("package-lock.json"),
      compiledDir,
    ]);
    const isNew = await cached(at("target", "www.stamp"), inputs, [join(siteDir, "index.html")], async () => {
      const [node, vite] = nodeProgram("vite");
      await run(node, [vite, "build", "--config", at("www", "vite.config.mjs")]);
      cpSync(at("www", "samples"), join(siteDir, "samples"), { recursive: true });
    });
    say(isNew ? "target/www" : "target/www, up to date");
  });
});
