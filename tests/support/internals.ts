/** Modules that the installed package does not export, and those of the repository's commands. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { repository } from "./environment.js";

/** The module at this path in the package. */
// biome-ignore lint/suspicious/noExplicitAny: their types are those of the sources, which the tests do not see.
export const internalModule = (path: string): Promise<any> =>
  import(new URL(`../../node_modules/sim3align/${path}`, import.meta.url).href);

/** The module at this path in `scripts/`. */
// biome-ignore lint/suspicious/noExplicitAny: as above.
export const scriptModule = (path: string): Promise<any> =>
  import(pathToFileURL(join(repository, "scripts", path)).href);

/** A module of the package's sources, which the package holds only as a part of a bundle. */
// biome-ignore lint/suspicious/noExplicitAny: as above.
export async function sourceModule(path: string): Promise<any> {
  const { build } = await import(pathToFileURL(join(repository, "node_modules", "esbuild", "lib", "main.js")).href);
  const entryPoints = [join(repository, "pkg-config", "src", path)];
  const { outputFiles } = await build({ entryPoints, bundle: true, write: false, format: "esm", platform: "node" });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);
}
