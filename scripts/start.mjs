/**
 * `npm start`: builds everything, serves the page on this machine, and opens it where there is a screen.
 * `npm start -- --check` shows it to a headless Chromium instead, prints the first result and the times to it, and ends.
 */
import { spawn } from "node:child_process";
import { parseArgs } from "node:util";
import { siteDir } from "./lib/paths.mjs";
import { launchChromium } from "./lib/programs.mjs";
import { buildSite } from "./lib/site.mjs";
import { serve } from "./lib/static-server.mjs";
import { script } from "./lib/step.mjs";

/** The same port every time, so that the browser knows the page again. */
const PORT = 4173;
/** How long a slow machine may take for the first result, in milliseconds. */
const LIMIT_MS = 120_000;

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

/** Opens the page, and prints what it says of its first sample, and after which time. @param {string} url */
async function check(url) {
  const browser = await launchChromium();
  try {
    const page = await browser.newPage();
    page.setDefaultTimeout(LIMIT_MS);
    await page.goto(url);
    const status = page.locator('#status:is([data-state="done"], [data-state="failed"]):not(.behind)');
    await status.filter({ hasText: /Aligned|:/ }).waitFor();
    await page.locator("#dimensions").waitFor();
    const text = async (/** @type {string} */ selector) => (await page.textContent(selector))?.trim();
    const [paint, aligned] = await page.evaluate(() =>
      ["first-contentful-paint", "aligned"].map(
        (name) => performance.getEntriesByName(name)[0]?.startTime ?? Number.NaN,
      ),
    );
    console.log(`
${await text("#status")}
Size: ${await text("#dimensions")}
Confidence: ${await text("#confidence")}
First paint after ${Math.round(paint ?? 0)} ms, result after ${Math.round(aligned ?? 0)} ms`);
  } finally {
    await browser.close();
  }
}

const usage = `Usage: npm start -- [options]

Builds everything, serves the demo page on this machine, and opens it.

Options:
  --check     a headless Chromium shows the page; prints its first result and the times to it, and ends
  --no-open   leaves the browser closed, and prints the address only
  -h, --help  display help for command`;

await script(async () => {
  const { values } = parseArgs({
    options: { check: { type: "boolean" }, "no-open": { type: "boolean" }, help: { type: "boolean", short: "h" } },
  });
  // No package is installed yet, and so no parser that would write this.
  if (values.help) return console.log(usage);
  await buildSite();
  const server = await serve(siteDir, PORT);
  if (values.check) return check(server.url).finally(server.close);
  console.log(`\n  The page:  ${server.url}\n  Ctrl-C ends it.\n`);
  if (!values["no-open"]) openInBrowser(server.url);
});
