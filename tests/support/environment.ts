/** Paths that the test script passes to the tests in environment variables. */
import { join } from "node:path";

/** An environment variable that the test script sets. */
export function required(name: string): string {
  const value = process.env[name];
  if (value === undefined) throw new Error(`${name} is not set: run the tests by "npm test".`);
  return value;
}

/** The repository's folder. */
export const repository = required("SIM3ALIGN_REPOSITORY");

/** The case folder of the generated sample. */
export const sampleDir = required("SIM3ALIGN_SAMPLE");

/** The folder into which the package is installed, as its users install it. */
export const installDir = process.cwd();

/** The script of the installed package's command line, to be run by `process.execPath`. */
export const commandLine = join(installDir, "node_modules", "sim3align", "cli", "main.js");

/** The folder that tests of the element serve, and the element of the installed package below it. */
export const servedFolder = join(repository, "target");
export const elementFolder = "install-test/node_modules/sim3align/element";
