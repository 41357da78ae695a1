/** A Chromium for the browser tests: found, or installed where that is possible. */
import { existsSync } from "node:fs";
import { delimiter, join } from "node:path";
import { attempt } from "./run.mjs";

const programs = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
const elsewhere = [
  "/Applications/Chromium.app/Contents/MacOS/Chromium",
  "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
  "C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe",
];

/** What to do where there is none. */
export const chromiumRemedy =
  "install Chromium (Debian and Ubuntu: apt-get install chromium), or name one in CHROMIUM_PATH";

/** @returns {string | undefined} the path of an installed Chromium or Chrome */
function find() {
  const named = process.env.CHROMIUM_PATH;
  if (named) {
    if (existsSync(named)) return named;
    throw new Error(`CHROMIUM_PATH names ${named}, which does not exist. Remedy: correct or unset it.`);
  }
  const onPath = (process.env.PATH ?? "")
    .split(delimiter)
    .flatMap((folder) => programs.map((program) => join(folder, program)));
  return [...onPath, ...elsewhere].find((path) => existsSync(path));
}

/**
 * Finds Chromium; installs it where there is none and this process may (Debian or Ubuntu, as root).
 * @returns {Promise<string | undefined>} its path
 */
export async function chromium() {
  const found = find();
  if (found || process.platform !== "linux" || process.getuid?.() !== 0) return found;
  const silent = { env: { DEBIAN_FRONTEND: "noninteractive" } };
  await attempt("apt-get", ["update"], silent);
  await attempt("apt-get", ["install", "--yes", "--no-install-recommends", "chromium"], silent);
  return find();
}
