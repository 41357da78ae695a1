/**
 * `npm start`: builds everything, serves the page on this machine, and opens it where there is a screen.
 * `npm start -- --check` shows it to a headless Chromium instead, prints the first result, and ends.
 */
import { spawn } from "node:child_process";
import { parseArgs } from "node:util";
import { chromium, chromiumRemedy } from "./lib/chromium.mjs";
import { buildPackage } from "./lib/package.mjs";
import { setUp } from "./lib/setup.mjs";
import { buildSite, siteDir } from "./lib/site.mjs";
import { serve } from "./lib/static-server.mjs";
import { script } from "./lib/step.mjs";

/** The same one every time, so that the browser knows the page again. */
const PORT = 4173;

/** Serves the site; on any free port, where somebody else has ours. */
async function serveSite() {
  try {
    return await serve(siteDir, PORT);
  } catch (error) {
    if (/** @type {NodeJS.ErrnoException} */ (error).code !== "EADDRINUSE") throw error;
    return serve(siteDir);
  }
}

/**
 * Opens an address in the default browser, where somebody would see it.
 * @param {string} url
 */
function openInBrowser(url) {
  const { platform, env } = process;
  const hasScreen = platform !== "linux" || env.DISPLAY || env.WAYLAND_DISPLAY;
  if (!hasScreen || env.CI) return;
  const [command, ...args] = { darwin: ["open"], win32: ["cmd", "/c", "start", ""] }[String(platform)] ?? ["xdg-open"];
  const child = spawn(command ?? "", [...args, url], { stdio: "ignore", detached: true });
  // The address is printed: nothing is lost.
  child.on("error", () => {});
  child.unref();
}

/** @param {string} url */
async function check(url) {
  const executable = await chromium();
  if (executable === undefined) throw new Error(`No Chromium. Remedy: ${chromiumRemedy}.`);
  // It needs Playwright, which the set-up has installed by now.
  const { firstResult } = await import("./lib/first-result.mjs");
  const { status, dimensions, confidence, milliseconds } = await firstResult(executable, url);
  console.log(`\n${status}\nSize: ${dimensions}\nConfidence: ${confidence}\nAfter ${Math.round(milliseconds)} ms`);
}

await script(async () => {
  const { values } = parseArgs({ options: { check: { type: "boolean" }, "no-open": { type: "boolean" } } });
  await setUp();
  await buildPackage();
  await buildSite();
  const server = await serveSite();
  if (values.check) {
    await check(server.url).finally(server.close);
    return;
  }
  console.log(`\n  The page:  ${server.url}\n  Ctrl-C ends it.\n`);
  if (!values["no-open"]) openInBrowser(server.url);
  for (const signal of ["SIGINT", "SIGTERM"]) process.once(signal, () => server.close().then(() => process.exit(0)));
});
