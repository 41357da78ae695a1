/** Statements of the page: sizes along an object's own sides, and causes of differences between mask and mesh. */
import assert from "node:assert/strict";
import {
  depthInUnits,
  drop,
  type Files,
  files,
  halfCamera,
  maskPng,
  nearIsDark,
  SIDES_M,
  seen,
  tiltedBox,
} from "../support/page-files.js";
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

/** The inputs with a mistake, whether the sheet asks about them, the cause that is named, and the button that helps. */
const mistakes: readonly [mistake: string, dropped: Files, asks: boolean, cause: string, helps: string][] = [
  ["the camera of a smaller image", { ...files, "camera.json": halfCamera }, false, "camera", "Scale them by 2"],
  ["a picture of the depth, near is dark", nearIsDark, true, "depth", "Near is dark"],
];
test("a mask of the background is inverted in the sheet", async (opened, page) => {
  await drop(opened, { ...files, "mask.png": maskPng(seen.mask.map((inside) => 1 - inside)) });
  await (await opened.sheet()).getByRole("button", { name: "Invert it" }).first().click();
  await opened.shows("Own files");
  await page.locator(".badge", { hasText: "Likely correct" }).waitFor(PATIENCE);
});

for (const [mistake, dropped, asks, cause, helps] of mistakes) {
  test(`${mistake}: the cause is named, and one button removes it`, async (opened, page) => {
    await drop(opened, dropped);
    if (asks) {
      await opened.sheet();
      await page.click("#intake-open");
    }
    await page.locator(`.advice[data-cause="${cause}"]`).waitFor(PATIENCE);
    await page.locator(".advice").getByRole("button", { name: helps }).click();
    await page.locator(`.advice[data-cause="${cause}"]`).waitFor({ state: "detached", ...PATIENCE });
    await opened.aligned();
    await page.locator(".badge", { hasText: /Likely correct|Check it/ }).waitFor(PATIENCE);
  });
}

test("a unit that was assumed is asked about, where the object would be as large as furniture", async (opened, page) => {
  // 5000 units per metre, as some datasets have, are taken for millimetres.
  await drop(opened, depthInUnits(5000));
  assert.match(await advice(opened), /^unit: Is it really .* cm across and 3\.\d+ m away\? .* read in 0\.001 m/);
  assert.match((await page.textContent(".badge")) ?? "", /Check the size/);
  // A unit that was chosen is not asked about.
  await page.locator(".advice button", { hasText: /^0\.2 mm: / }).click();
  await page.locator(".badge", { hasText: "Likely correct" }).waitFor(PATIENCE);
});
