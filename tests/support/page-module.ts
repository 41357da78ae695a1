/** Modules of the page that run in Node, too. */
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import { installDir, repository } from "./environment.js";

/** The module at this path in `www/src`, bundled. The installed package stays outside, so that its errors are the same. */
export async function pageModule<T>(path: string): Promise<T> {
  const outfile = join(installDir, "page-modules", `${path}.mjs`);
  mkdirSync(join(outfile, ".."), { recursive: true });
  const entryPoints = [join(repository, "www", "src", `${path}.ts`)];
  await build({ entryPoints, outfile, bundle: true, format: "esm", external: ["sim3align"] });
  return import(pathToFileURL(outfile).href);
}
