/** Programs of the system that tests need: Chromium, Firefox and Redis. */
import { existsSync } from "node:fs";
import { delimiter, resolve } from "node:path";
import { once } from "./cache.mjs";
import { run } from "./run.mjs";
import { step } from "./step.mjs";

/**
 * By the environment variable that may name them: names on the path in order of preference, of which the first is Debian's
 * package, and paths elsewhere.
 */
const programs = {
  CHROMIUM_PATH: [
    ...["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"],
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe",
  ],
  FIREFOX_PATH: [
    ...["firefox-esr", "firefox", "/Applications/Firefox.app/Contents/MacOS/firefox"],
    "C:\\Program Files\\Mozilla Firefox\\firefox.exe",
  ],
  REDIS_SERVER_PATH: ["redis-server", "/opt/homebrew/bin/redis-server", "/usr/local/bin/redis-server"],
};

/** @param {keyof typeof programs} variable @returns {string | undefined} its path */
function find(variable) {
  const named = process.env[variable];
  if (named && !existsSync(named)) throw new Error(`${variable} names ${named}, which does not exist.`);
  const folders = (process.env.PATH ?? "").split(delimiter);
  const paths = folders.flatMap((folder) => programs[variable].map((name) => resolve(folder, name)));
  return named || paths.find((path) => existsSync(path));
}

/**
 * Finds a program. Installs it only in continuous integration (`CI` set), on Debian or Ubuntu, as root: on other
 * machines that is for their owners to do.
 * @param {keyof typeof programs} variable
 * @returns {Promise<string | undefined>} its path
 */
async function locate(variable) {
  const found = find(variable);
  if (found || !process.env.CI || process.platform !== "linux" || process.getuid?.() !== 0) return found;
  const [debianPackage = ""] = programs[variable];
  await step(`apt-get install ${debianPackage}`, async () => {
    // Run level 1 keeps the package's services from being started.
    const env = { DEBIAN_FRONTEND: "noninteractive", RUNLEVEL: "1" };
    await run("apt-get", ["update"], { env });
    await run("apt-get", ["install", "--yes", "--no-install-recommends", debianPackage], { env });
  });
  return find(variable);
}

/** The remedy for a missing Chromium. */
export const chromiumRemedy =
  "install Chromium (Debian and Ubuntu: apt-get install chromium), or name it in CHROMIUM_PATH";

/** Chromium's path, or undefined where there is none. */
export const chromium = once(() => locate("CHROMIUM_PATH"));

/**
 * Firefox's path, or undefined where there is none: tests in it are then skipped, because some distributions have no
 * package of it. It waits for Chromium: apt-get runs once at a time.
 */
export const firefox = once(async () => {
  await chromium();
  return locate("FIREFOX_PATH").catch(() => undefined);
});

/** The path of Redis' server, or undefined where there is none. */
export const redisServer = once(async () => {
  await firefox();
  return locate("REDIS_SERVER_PATH");
});

/** Starts a headless Chromium. @throws where there is none */
export async function launchChromium() {
  const executablePath = await chromium();
  if (executablePath === undefined) throw new Error(`No Chromium. Remedy: ${chromiumRemedy}.`);
  // The set-up installs it first.
  const playwright = await import("playwright-core");
  return playwright.chromium.launch({ executablePath, args: ["--no-sandbox", "--no-first-run"] });
}
