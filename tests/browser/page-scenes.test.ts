/** Several scenes: in one list, in several tabs, and one after the other while alignments run. */
import assert from "node:assert/strict";
import type { Page } from "playwright-core";
import { drop, dropFolder, files, four } from "../support/page-files.js";
import { PATIENCE, pageTests, SitePage } from "../support/site.js";

const test = pageTests();

const isShown = (page: Page, scene: string) => page.locator(`main[data-scene="${scene}"]`).waitFor(PATIENCE);

const states = (page: Page) => page.locator(".scenes li").allTextContents();

test("the work on all scenes of a drop is kept: in the list, in one file, and after a reload", async (opened, page) => {
  await dropFolder(opened, four);
  await opened.sheet();
  await page.click("#intake-open");
  await opened.shows("IMG_001");
  await page.click("#accept");
  const [size] = await opened.dimensions();
  await page.click("#next");
  await opened.shows("IMG_002");
  await page.click(".hand-panel .more summary");
  await opened.press("Move left");
  await opened.isNow("hand");
  await page.click("#accept");
  const moved = await page.textContent("#centre");
  await page.click("#next");
  await opened.shows("IMG_003");
  // The last one is aligned, too, though nobody has opened it.
  await page.locator(".scenes li", { hasText: /^IMG_004 (\d+ %|look at it)/ }).waitFor(PATIENCE);
  assert.deepEqual(
    (await states(page)).slice(0, 2).map((text) => text.replace(/^IMG_00\d /, "")),
    ["✓ accepted", "✓ accepted"],
  );
  assert.deepEqual(await opened.violations(), []);
  type Result = Record<string, { decision: string | null; sizeM: number[]; source: string }>;
  const { name, bytes } = await opened.saved("JSON of all scenes");
  assert.equal(name, "scenes.json");
  const all = JSON.parse(`${bytes}`) as Record<string, Result | null>;
  assert.deepEqual(Object.keys(all), ["IMG_001", "IMG_002", "IMG_003", "IMG_004"]);
  assert.notEqual(all.IMG_004, null);
  const [first, second] = [Object.values(all.IMG_001 ?? {})[0], Object.values(all.IMG_002 ?? {})[0]];
  assert.deepEqual([first?.decision, second?.decision, second?.source], ["accepted", "corrected", "hand"]);
  assert.equal((100 * (first?.sizeM[0] ?? 0)).toFixed(1), size?.toFixed(1));

  await opened.kept();
  await page.reload();
  await isShown(page, "IMG_003");
  // The list comes after the first picture.
  await page.locator(".scenes li").nth(3).waitFor(PATIENCE);
  assert.equal(await page.locator(".scenes li").count(), 4);
  await page.locator(".scenes button", { hasText: "IMG_002" }).click();
  await isShown(page, "IMG_002");
  await opened.isNow("hand");
  assert.equal(await page.textContent("#centre"), moved);
  assert.match((await page.textContent("#accept")) ?? "", /Accepted/);
  await page.locator(".scenes button", { hasText: "IMG_004" }).click();
  await opened.shows("IMG_004");
  await opened.click("#forget");
  await isShown(page, "IMG_003");
  assert.equal(await page.locator(".scenes li").count(), 3);
});

/** A second tab of the same browser, once its first scene is aligned. */
async function secondTab(page: Page): Promise<SitePage> {
  const [tab] = await Promise.all([page.waitForEvent("popup"), page.evaluate(() => void open(location.href))]);
  const opened = new SitePage(tab, []);
  await opened.aligned();
  return opened;
}

const early = { isLoading: true };
test("a tab that does not answer is taken over, and stores nothing from then on", early, async (opened, page) => {
  // As one that the browser has frozen.
  await page.addInitScript(() => {
    BroadcastChannel.prototype.addEventListener = () => {};
  });
  await page.reload();
  await opened.aligned();
  await drop(opened, files);
  await opened.shows("Own files");
  await opened.kept();
  const other = await secondTab(page);
  await other.press("Take over");
  await isShown(other.page, "Own files");
  await other.page.click("#accept");
  await other.kept();
  await opened.says(/Another tab has taken over Own files/);
  await other.page.reload();
  await isShown(other.page, "Own files");
  assert.match((await other.page.textContent("#accept")) ?? "", /Accepted/);
  await other.page.close();
});
