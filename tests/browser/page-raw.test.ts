/** Depth that a model guessed, and cameras that nobody has given: sizes without a unit, until one of them is known. */
import assert from "node:assert/strict";
import { greyJpeg, tiff } from "../support/exif.js";
import { png } from "../support/files.js";
import { drop, type Files, files, HEIGHT, maskPng, seen, WIDTH } from "../support/page-files.js";
import { mesh, truth } from "../support/scene.js";
import { pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

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
    // Of the size of the depth map, and with its focal length: 300 pixels are 65 mm on full frame.
    "photo.jpg": greyJpeg(tiff({ make: "Maker" }, { focal35: 65, pixelX: WIDTH, pixelY: HEIGHT }, true), WIDTH, HEIGHT),
    "depth.png": disparityPng(seen.depth),
    "mask.png": maskPng(seen.mask),
    "mesh.obj": files["mesh.obj"] as Uint8Array,
  };
  await drop(opened, dropped);
  const sheet = await opened.sheet();
  assert.equal(await page.inputValue("#depth-kind"), "affine-invariant-disparity");
  assert.match((await page.textContent("#depth-unit")) ?? "", /No unit/);
  assert.match((await sheet.locator('[data-field="camera"]').textContent()) ?? "", /EXIF: 65 mm/);
  assert.match((await sheet.textContent()) ?? "", /looks like relative disparity/);
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
