/** The API reference, written by typedoc from the package's sources. */
import { cpSync, existsSync, mkdirSync, rmSync } from "node:fs";
import { basename, join } from "node:path";
import { cached, digest } from "./cache.mjs";
import { at, docsDir, skinDir } from "./paths.mjs";
import { run } from "./run.mjs";

/** typedoc, and the compiler that it is made for, apart from the repository's own. */
const tools = at("target", "typedoc");
const manifests = ["package.json", "package-lock.json"];

async function installTools() {
  const sources = [...manifests.map((name) => at("scripts", "docs", name)), at(".npmrc")];
  await cached(join(tools, "installed-from"), digest(sources), [join(tools, "node_modules")], async () => {
    rmSync(tools, { recursive: true, force: true });
    mkdirSync(tools, { recursive: true });
    for (const source of sources) cpSync(source, join(tools, basename(source)));
    await run("npm", ["ci", "--prefer-offline"], {
      cwd: tools,
      remedy: "check that the npm registry can be reached, and that scripts/docs/package-lock.json is up to date",
    });
  });
}

/**
 * Writes the reference to {@link docsDir}. The modules have to be built: their declarations are part of it.
 * @throws for everything that typedoc warns of: exports without documentation, and links that lead nowhere
 */
export async function writeApiDocs() {
  await installTools();
  const typedoc = join(tools, "node_modules", "typedoc", "bin", "typedoc");
  const sources = [skinDir, at("docs"), at("README.md"), at("CHANGELOG.md"), at("scripts", "docs")];
  await cached(join(tools, "written-from"), digest(sources), [join(docsDir, "index.html")], async () => {
    // Plugins are looked for from the working directory.
    await run(process.execPath, [typedoc, "--options", at("scripts", "docs", "typedoc.json")], {
      cwd: tools,
      remedy: "document what typedoc names, and correct its links, in pkg-config/src and docs/guides",
    });
  });
  if (!existsSync(join(docsDir, "index.html"))) throw new Error("typedoc wrote no index.html to target/docs.");
}
