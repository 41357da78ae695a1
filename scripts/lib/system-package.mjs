/** Programs that come with the system: found, or installed where that is possible. */
import { existsSync } from "node:fs";
import { delimiter, join } from "node:path";
import { attempt } from "./run.mjs";

/**
 * @typedef {object} SystemProgram
 * @property {string} variable the environment variable that may name it
 * @property {readonly string[]} programs its names on the path, in order of preference
 * @property {readonly string[]} elsewhere files that it may be in
 * @property {string} debianPackage what it is in on Debian and Ubuntu
 */

/**
 * @param {SystemProgram} program
 * @returns {string | undefined} its path
 */
function find({ variable, programs, elsewhere }) {
  const named = process.env[variable];
  if (named) {
    if (existsSync(named)) return named;
    throw new Error(`${variable} names ${named}, which does not exist. Remedy: correct or unset it.`);
  }
  const onPath = (process.env.PATH ?? "")
    .split(delimiter)
    .flatMap((folder) => programs.map((name) => join(folder, name)));
  return [...onPath, ...elsewhere].find((path) => existsSync(path));
}

/**
 * Finds a program; installs it where there is none and this process may (Debian or Ubuntu, as root).
 * @param {SystemProgram} program
 * @returns {Promise<string | undefined>} its path
 */
export async function installed(program) {
  const found = find(program);
  if (found || process.platform !== "linux" || process.getuid?.() !== 0) return found;
  // Run level 1 keeps a package's services from being started.
  const silent = { env: { DEBIAN_FRONTEND: "noninteractive", RUNLEVEL: "1" } };
  await attempt("apt-get", ["update"], silent);
  await attempt("apt-get", ["install", "--yes", "--no-install-recommends", program.debianPackage], silent);
  return find(program);
}
