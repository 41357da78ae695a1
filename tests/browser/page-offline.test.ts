/** Without a connection: the page, its samples and own files work after the first visit, and a new version replaces the old one. */
import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { serve } from "../support/browser.js";
import { drop, files } from "../support/page-files.js";
import { PATIENCE, pageTests, siteDir, until } from "../support/site.js";

const test = pageTests();
const visit = { serviceWorkers: "allow", isLoading: true } as const;

const folder = mkdtempSync(join(tmpdir(), "sim3align-site-"));
after(() => rmSync(folder, { recursive: true, force: true }));

test("after the first visit, the page and all samples work without a connection", visit, async (opened, page) => {
  const isStored = () => page.locator("#privacy", { hasText: "Works offline" }).waitFor(PATIENCE);
  await isStored();
  await page.context().setOffline(true);
  await page.reload();
  await opened.aligned();
  await isStored();
  await opened.sample("desk");
  await opened.shows("Desk");
  await page.keyboard.press("?");
  await page.locator("dialog.help").waitFor(PATIENCE);
  await page.keyboard.press("Escape");
  await drop(opened, files);
  await page.locator(".start[data-own=true]").waitFor(PATIENCE);
  await opened.aligned();
});

test("a new version is shown at the next load, and the one before is forgotten", visit, async (_, page) => {
  const site = join(folder, "site");
  cpSync(siteDir, site, { recursive: true });
  const outside = '<link rel="icon" href="data:,"><title>A page that the site\'s worker does not control</title>';
  writeFileSync(join(folder, "outside.html"), outside);
  const server = await serve(folder);
  try {
    await page.goto(`${server.url}site/index.html#sample=mug`);
    await page.locator("#privacy", { hasText: "Works offline" }).waitFor(PATIENCE);
    const caches = () => page.evaluate(async () => (await globalThis.caches.keys()).sort());
    const [old, ...others] = await caches();
    assert.deepEqual(others, []);
    const edit = (name: string, from: string | RegExp, to: string) => {
      const path = join(site, name);
      const text = readFileSync(path, "utf8");
      assert.notEqual(text.replace(from, to), text, name);
      writeFileSync(path, text.replace(from, to));
    };
    edit("index.html", "<title>sim3align</title>", "<title>newer</title>");
    edit("service-worker.js", /BUILD = "\w+"/, 'BUILD = "newer"');
    await page.reload();
    assert.equal(await page.title(), "newer");
    await page.locator("#privacy", { hasText: "Reload for a new version" }).waitFor(PATIENCE);
    // Once no page of the old version is open, its files are forgotten. A page of the site that opens before the old worker
    // has stopped would keep it, so this looks from outside.
    await page.goto(`${server.url}outside.html`);
    const left = await until(caches, (found) => !found.includes(old ?? ""));
    assert.deepEqual(left, ["sim3align-newer"]);
  } finally {
    await server.close();
  }
});
