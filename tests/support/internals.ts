/** What the installed package does not export, and modules of the repository's commands. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { repository } from "./environment.js";

/** The glue of a WebAssembly module of the package, with the instance that the package's functions use. */
// biome-ignore lint/suspicious/noExplicitAny: their types are those of the sources, which the tests do not see.
export const glueModule = (name: string): Promise<any> =>
  import(new URL(`../../node_modules/sim3align/wasm/${name}.js`, import.meta.url).href);

/** A module of the package's sources, compiled; the package holds it only as a part of a bundle. */
// biome-ignore lint/suspicious/noExplicitAny: as above.
export const sourceModule = (path: string): Promise<any> =>
  import(pathToFileURL(join(repository, "target", "compiled", path)).href);

/** The module at this path in `scripts/`. */
// biome-ignore lint/suspicious/noExplicitAny: as above.
export const scriptModule = (path: string): Promise<any> =>
  import(pathToFileURL(join(repository, "scripts", path)).href);
