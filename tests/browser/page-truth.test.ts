/** Statements of the page: sizes along an object's own sides, and causes of differences between mask and mesh. */
import assert from "node:assert/strict";
import { depthInUnits, SIDES_M, tiltedBox } from "../support/page-cases.js";
import { drop } from "../support/page-files.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

const sorted = (sides: readonly number[]) => [...sides].sort((a, b) => a - b);

test("sizes are those of the object's sides, in a file of any axes", async (opened, page) => {
  await drop(opened, tiltedBox());
  await opened.shows("Own files");
  const sides = sorted(await opened.dimensions());
  for (const [k, side] of SIDES_M.entries()) {
    assert.ok(Math.abs((sides[k] ?? 0) / (100 * side) - 1) < 0.04, `${sides}, true are ${SIDES_M}`);
  }
  const json = JSON.parse(`${(await opened.saved("JSON")).bytes}`) as Record<string, { sizeM: number[] }>;
  const saved = sorted(Object.values(json)[0]?.sizeM ?? []);
  for (const [k, side] of saved.entries()) assert.ok(Math.abs(100 * side - (sides[k] ?? 0)) < 0.06, `${saved}`);
  const trial = page.locator(".hand-panel .trial");
  // A known edge leaves the others in proportion.
  await opened.choose('.hand-panel [aria-label="Edge"]', "1");
  await opened.enter("#known-size", "9.3");
  await trial.locator("p", { hasText: "The mesh fits" }).waitFor(PATIENCE);
  await opened.press("Use");
  const known = sorted(await opened.dimensions());
  for (const [k, side] of SIDES_M.entries())
    assert.ok(Math.abs((known[k] ?? 0) * (0.092 / 9.3) - side) < 0.002, `${known}`);
  assert.ok(await page.isChecked("#lock-scale"));
});

/** The cause that the page names, and its sentence. */
const advice = async ({ page }: SitePage) => {
  const sentence = page.locator(".advice");
  await sentence.waitFor(PATIENCE);
  return `${await sentence.getAttribute("data-cause")}: ${await sentence.textContent()}`;
};

test("only what stands in front of an object explains a low overlap", "#sample=occluded", async (opened, page) => {
  assert.match(await advice(opened), /^occluded: .*\d+ % of the object is behind something else/);
  // Dragged behind the wall, the object is hidden as well, but not where it was seen.
  await page.click(".hand-panel .more summary");
  await page.fill("#centre-z", "500");
  await page.press("#centre-z", "Enter");
  await opened.isNow("hand");
  await page.locator('.advice[data-cause="moved"]').waitFor(PATIENCE);
  assert.equal(await page.textContent(".badge"), "Moved by hand");
  await opened.press("Back to the result");
  await opened.isNow("aligned");
});

test("a unit that was assumed is asked about, where the object would be as large as furniture", async (opened, page) => {
  // 5000 units per metre, as some datasets have, are taken for millimetres.
  await drop(opened, depthInUnits(5000));
  assert.match(await advice(opened), /^unit: Is it really .* cm across and 3\.\d m away\? .* was assumed: 0\.001 m/);
  // A unit that was given is not asked about.
  await opened.press("Change the unit …");
  await opened.sheet();
  await page.selectOption("#depth-scale", "0.0002");
  await opened.sheet();
  await page.click("#intake-open");
  await page.locator(".advice").waitFor({ state: "detached", ...PATIENCE });
});
