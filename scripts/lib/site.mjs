/** The static site: `www/` with the built package and the samples, written to target/www. */
import { cpSync, existsSync, readdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { at, packageDir } from "./paths.mjs";
import { nodeProgram, run } from "./run.mjs";
import { makeSample, pageSamplesDir } from "./sample.mjs";
import { digest, Stamp } from "./stamp.mjs";
import { step } from "./step.mjs";

/** What `npm run build:www` writes: a folder for any static host, at any path. */
export const siteDir = at("target", "www");

/** Builds the site, unless nothing of it has changed; the package has to have been built. */
export async function buildSite() {
  await makeSample();
  await step("site", async (say) => {
    // The samples are among them.
    const sources = [at("www"), at("package-lock.json"), at("scripts", "lib", "site.mjs")];
    const inputs = digest([...sources, ...packageFiles()]);
    const stamp = new Stamp(at("target", "www.stamp"), inputs, [join(siteDir, "index.html")]);
    if (stamp.isCurrent) return say("target/www, up to date");
    stamp.clear();
    rmSync(siteDir, { recursive: true, force: true });
    const [node, vite] = nodeProgram("vite");
    await run(node, [vite, "build", "--config", at("www", "vite.config.mjs")]);
    cpSync(pageSamplesDir, join(siteDir, "samples"), { recursive: true });
    stamp.write();
    say("target/www");
  });
}

/** The package as the site uses it: without the facts about its build, which differ from commit to commit. */
function packageFiles() {
  if (!existsSync(packageDir)) throw new Error('There is no pkg/. Remedy: "npm run build".');
  return readdirSync(packageDir)
    .filter((name) => name !== "build-info.json" && !name.endsWith(".md"))
    .map((name) => join(packageDir, name));
}
