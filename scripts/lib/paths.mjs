/** Absolute paths of the repository. */
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const repository = join(dirname(fileURLToPath(import.meta.url)), "..", "..");

/**
 * A path inside the repository.
 * @param {...string} parts
 */
export const at = (...parts) => join(repository, ...parts);

/** The publishable package, written by `npm run build`. */
export const packageDir = at("pkg");
/** The package as the compiler writes it, a module for each source; the package's bundles are made of these. */
export const compiledDir = at("target", "compiled");
/** The package's sources: TypeScript, and its package.json. */
export const skinDir = at("pkg-config");
/** The generated glue, beside the TypeScript that imports it. */
export const glueDir = at("pkg-config", "src", "wasm");
/** Programs that the set-up installs. */
export const toolsDir = at("target", "tools");
/** The package, installed as its users install it, with the tests that use it. */
export const installDir = at("target", "install-test");
/** The static site, written by `npm run build:www`, for any host and path. */
export const siteDir = at("target", "www");
/** The API reference, written by `npm run docs`. */
export const docsDir = at("target", "docs");
/** A case folder with depth as .npy, copied from the page's samples. */
export const sampleDir = at("target", "samples", "mug");
