/** From a photo, or from depth that a model guessed: the sheet names what is missing; sizes have no unit at first. */
import assert from "node:assert/strict";
import type { Page } from "playwright-core";
import { greyJpeg, tiff } from "../support/exif.js";
import { png } from "../support/files.js";
import { drop, type Files, files, HEIGHT, maskPng, seen, WIDTH } from "../support/page-files.js";
import { mesh, truth } from "../support/scene.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

/** A photo by the camera of the depth map, whose 300 pixels are 65 mm on full frame. */
const photoOf = (width: number, height: number) =>
  greyJpeg(tiff({ make: "Maker" }, { focal35: 65, pixelX: width, pixelY: height }, true), width, height);

const settled = (page: Page) =>
  page.locator("#mask-status[aria-busy=false]").filter({ hasText: "is marked" }).waitFor(PATIENCE);

/** The share of the image that is marked, per cent. */
const share = async (page: Page) => Number.parseInt((await page.textContent("#mask-status")) ?? "", 10);

const trueShare = (100 * seen.mask.reduce((sum, inside) => sum + inside, 0)) / seen.mask.length;

test("a photo alone is shown with its focal length, and the guide to the rest is linked", async (opened, page) => {
  await drop(opened, { "IMG_0815.jpg": photoOf(2 * WIDTH, 2 * HEIGHT) });
  const sheet = await opened.sheet();
  const pictured = sheet.locator('[data-field="photo"] canvas');
  await pictured.waitFor(PATIENCE);
  assert.equal(await pictured.getAttribute("width"), `${2 * WIDTH}`);
  assert.match((await sheet.locator('[data-field="photo"]').textContent()) ?? "", /IMG_0815\.jpg.*320 × 240/);
  assert.match((await sheet.locator('[data-field="camera"]').textContent()) ?? "", /EXIF: 65 mm/);
  assert.match(await page.inputValue("#camera-fx"), /^6\d\d/);
  const guide = await sheet.locator(".from-photo a").evaluate((one) => (one as HTMLAnchorElement).href);
  assert.match(await page.evaluate(async (link) => (await fetch(link)).text(), guide), /From one photo/);
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

/** Disparity as a model draws it: 256 grey levels, near is bright, of which nobody knows the scale and the shift. */
function disparityPng(depth: Float32Array): Uint8Array {
  const inverse = depth.map((z) => 1 / z);
  const [low, high] = [Math.min(...inverse), Math.max(...inverse)];
  return png(
    Uint8Array.from(inverse, (d) => Math.round(20 + (220 * (d - low)) / (high - low))),
    WIDTH,
    HEIGHT,
  );
}

/** A unit of length after a number, or alone. */
const UNIT = /(\d\s*|\b)(mm|cm|m)\b/;

const shownText = ({ page }: SitePage) => page.evaluate(() => document.querySelector(".page")?.textContent ?? "");

test("a photo, relative disparity, a mask and a mesh without a camera are aligned, in no unit", async (opened, page) => {
  const dropped: Files = {
    "photo.jpg": photoOf(WIDTH, HEIGHT),
    "depth.png": disparityPng(seen.depth),
    "mask.png": maskPng(seen.mask),
    "mesh.obj": files["mesh.obj"] as Uint8Array,
  };
  await drop(opened, dropped);
  const sheet = await opened.sheet();
  assert.equal(await page.inputValue("#depth-kind"), "affine-invariant-disparity");
  assert.match((await page.textContent("#depth-unit")) ?? "", /No unit/);
  assert.match((await sheet.locator('[data-field="camera"]').textContent()) ?? "", /EXIF: 65 mm/);
  assert.match((await sheet.textContent()) ?? "", /looks like relative depth/);
  await page.click("#intake-open");
  await opened.shows("Own files");
  assert.ok((await opened.metric("iou")) > 0.9);
  const sizes = await opened.dimensions();
  assert.equal(Math.max(...sizes), 1);
  await page.click(".details summary");
  await page.click(".hand-panel .more summary");
  await opened.choose('[aria-label="Background"]', "depth");
  await page.hover(".image canvas");
  const text = await shownText(opened);
  assert.doesNotMatch(text.replace(/(\d+) mm \(35 mm equivalent\)/g, ""), UNIT);
  assert.match(text, /Disparity, near is large; no unit.*shift.*Focal length \d+ px ± \d+ %; EXIF/s);
  const json = JSON.parse(`${(await opened.saved("JSON")).bytes}`);
  assert.equal(json._about.units, "unknown");
  assert.equal(json._about.depthCalibration.isMetric, false);
  assert.ok(!("sizeM" in json.Object), "a size in metres");

  // The longest side of the blob, which nobody has told yet.
  const sides = [0, 1, 2].map((k) => {
    const along = mesh.positions.filter((_, i) => i % 3 === k);
    return truth.scale * (Math.max(...along) - Math.min(...along));
  });
  const longest = 100 * Math.max(...sides);
  await opened.enter("#known-size", longest.toFixed(2));
  await page.locator("#dimensions", { hasText: "cm" }).waitFor();
  const metric = await opened.dimensions();
  assert.ok(Math.abs(Math.max(...metric) - longest) < 0.1, `${metric}, known is ${longest}`);
  const distance = Number.parseFloat((await page.textContent("#centre"))?.split(",")[2] ?? "");
  assert.ok(Math.abs(distance / truth.translation[2] - 1) < 0.25, `${distance} m away`);
  const known = JSON.parse(`${(await opened.saved("JSON")).bytes}`);
  assert.equal(known._about.units, "metres");
  // Undoing it leaves what was shown before.
  await page.click("#undo");
  await page.locator("#dimensions", { hasText: "relative" }).waitFor();
  assert.deepEqual(await opened.dimensions(), sizes);
  await page.click("#redo");
  // It is kept by the next alignment.
  await page.click("#align");
  await page.locator("#cancel").waitFor({ state: "detached" });
  await opened.aligned();
  assert.ok(Math.abs(Math.max(...(await opened.dimensions())) - longest) < 0.1);
  assert.deepEqual(await opened.violations(), []);
});
