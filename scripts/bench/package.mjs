/** The built package, as these commands use it: its own entry, and modules that it does not export. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { buildPackage } from "../lib/package.mjs";
import { packageDir } from "../lib/paths.mjs";
import { setUp } from "../lib/setup.mjs";

/**
 * A module of the built package.
 * @param {string} file
 */
export const packageModule = (file) => import(pathToFileURL(join(packageDir, file)).href);

/** Builds the package where its sources have changed. */
export async function builtPackage() {
  await setUp();
  await buildPackage();
}
