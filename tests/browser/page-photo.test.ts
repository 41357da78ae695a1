/** From one photo: what is there is shown, the sheet says where the rest comes from, and the mask is marked on it. */
import assert from "node:assert/strict";
import type { Page } from "playwright-core";
import { greyJpeg, tiff } from "../support/exif.js";
import { drop, files, HEIGHT, maskPng, seen, WIDTH } from "../support/page-files.js";
import { PATIENCE, pageTests } from "../support/site.js";

const test = pageTests();

/** Twice as large as the depth map, as photos are; 65 mm on full frame are 300 pixels of the depth map. */
const [ACROSS, DOWN] = [2 * WIDTH, 2 * HEIGHT];
const photo = greyJpeg(tiff({ make: "Maker" }, { focal35: 65, pixelX: ACROSS, pixelY: DOWN }, true), ACROSS, DOWN);

const settled = (page: Page) =>
  page.locator("#mask-status[aria-busy=false]").filter({ hasText: "is marked" }).waitFor(PATIENCE);

/** The share of the image that is marked, per cent. */
const share = async (page: Page) => Number.parseInt((await page.textContent("#mask-status")) ?? "", 10);

const trueShare = (100 * seen.mask.reduce((sum, inside) => sum + inside, 0)) / seen.mask.length;

test("a photo alone is shown with its focal length, and the rest is named with its sources", async (opened, page) => {
  await drop(opened, { "IMG_0815.jpg": photo });
  const sheet = await opened.sheet();
  const pictured = sheet.locator('[data-field="photo"] canvas');
  await pictured.waitFor(PATIENCE);
  assert.equal(await pictured.getAttribute("width"), `${ACROSS}`);
  assert.match((await sheet.locator('[data-field="photo"]').textContent()) ?? "", /IMG_0815\.jpg.*320 × 240/);
  assert.match((await sheet.locator('[data-field="camera"]').textContent()) ?? "", /EXIF: 65 mm/);
  assert.match(await page.inputValue("#camera-fx"), /^6\d\d/);
  const guide = sheet.locator(".from-photo");
  const links = await guide.locator("a").evaluateAll((all) => all.map((one) => (one as HTMLAnchorElement).href));
  assert.ok(links.length >= 6 && links.every((link) => /^https:|docs\//.test(link)), `${links}`);
  const [own = ""] = links.filter((link) => link.includes("docs/"));
  assert.match(await page.evaluate(async (link) => (await fetch(link)).text(), own), /From one photo/);
  assert.ok(await page.isDisabled("#intake-open"));
  assert.deepEqual(await opened.violations(), []);
  // A mask of the photo is shown on it.
  await drop(opened, { "mask.png": maskPng(seen.mask) });
  await opened.sheet();
  assert.ok((await page.getAttribute("#mask-file", "accept"))?.split(",").includes(".jpg"));
  await sheet.locator(".pair canvas").first().waitFor(PATIENCE);
  assert.match((await sheet.locator('[data-field="photo"]').textContent()) ?? "", /IMG_0815\.jpg/);
  assert.match((await sheet.locator(".pair").textContent()) ?? "", /mask\.png/);
});

test("the mask of a scene with depth is marked by keyboard, corrected and taken back", async (opened, page) => {
  const { "mask.png": _, ...rest } = files;
  await drop(opened, rest);
  await opened.sheet();
  await page.getByRole("button", { name: "Mark", exact: true }).click();
  const here = page.locator("#mask-here");
  await here.waitFor(PATIENCE);
  await here.press("Enter");
  await settled(page);
  const found = await share(page);
  assert.ok(Math.abs(found - trueShare) < 2, `${found} of ${trueShare} %`);
  // Without following edges, the brush paints what it covers.
  await page.uncheck("#mask-edges");
  await page.locator("#mask-size").press("End");
  await here.press("x");
  await here.press("Enter");
  await page.waitForFunction(
    (before) => Number.parseInt(document.querySelector("#mask-status")?.textContent ?? "", 10) < before,
    found,
  );
  await here.press("Backspace");
  await page.locator("#mask-status", { hasText: `${found} % of` }).waitFor(PATIENCE);
  await page.click("#mask-done");
  await opened.shows("Own files");
  assert.ok((await opened.metric("iou")) > 0.85);
});
