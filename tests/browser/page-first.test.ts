/** The first screen: a photo scene, aligned by itself, and the ways to go on. */
import assert from "node:assert/strict";
import { WEBGL } from "../support/browser.js";
import { PATIENCE, pageTests } from "../support/site.js";

const test = pageTests(WEBGL);

const laptop = { address: "", viewport: { width: 1440, height: 900 } };

test("the page opens with a photo, whose objects are placed at their sizes", laptop, async ({ page }) => {
  assert.equal(await page.getAttribute("main", "data-scene"), "Table");
  assert.equal(await page.inputValue('[aria-label="Background"]'), "photo");
  const names = await page.locator(".objects .name").allTextContents();
  assert.deepEqual(names, ["Teapot", "Mug", "Box"]);
  for (const name of names) {
    await page.locator(".objects .select", { hasText: name }).click();
    await page.locator("#errors", { hasText: /scale [\d.]+ %/ }).waitFor(PATIENCE);
    const error = Number(/scale ([\d.]+) %/.exec((await page.textContent("#errors")) ?? "")?.[1]);
    assert.ok(error < 5, `${name}: the scale is ${error} % off`);
  }
  await page
    .locator('.space canvas[aria-label*="from the depth camera"][aria-label*="Teapot, Mug, Box"]')
    .waitFor(PATIENCE);
});

test(
  "one sentence, one large button and the result are in sight, and samples a click away",
  laptop,
  async (opened, page) => {
    assert.equal(await page.textContent(".claim"), "Place a 3D model in your photo at true scale.");
    const isInSight = async (part: string) => {
      const box = await page.locator(part).boundingBox();
      assert.ok(box !== null && box.y >= 0 && box.y + box.height <= 900, `${part} is at ${box?.y}`);
    };
    for (const part of [".claim", ".drop", "#dimensions", "#confidence", "#accept", ".objects", ".exports >> nth=0"])
      await isInSight(part);
    await page.getByRole("button", { name: "Samples and folders" }).click();
    assert.equal(await page.locator(".samples button").count(), 3);
    await isInSight(".samples button >> nth=2");
    await page.waitForFunction(() =>
      [...document.images].every(({ complete, naturalWidth }) => complete && naturalWidth > 0),
    );
    await page.locator('[data-sample="hammer"]').click();
    await opened.shows("Hammer");
    assert.equal(await page.getAttribute('[data-sample="hammer"]', "aria-pressed"), "true");
    assert.equal(await page.getAttribute('[data-sample="table"]', "aria-pressed"), "false");
  },
);

test("a sample that cannot be loaded leaves the scene and the list of samples as they are", async (opened, page) => {
  await page.route("**/samples/hammer/**", (route) => route.abort());
  await opened.choose("#sample", "hammer");
  await opened.says(/Hammer: /);
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  assert.equal(await page.inputValue("#sample"), "mug");
  assert.equal(await page.getAttribute('[data-sample="hammer"]', "aria-pressed"), "false");
  // The browser logs the requests that were refused.
  opened.errors.length = 0;
});

test("on a phone, image and result come first, and targets are large", {
  address: "",
  viewport: { width: 390, height: 844 },
  isMobile: true,
  hasTouch: true,
}, async ({ page }) => {
  const top = async (part: string) => (await page.locator(part).first().boundingBox())?.y ?? Number.NaN;
  const order = [
    await top(".start"),
    await top(".space"),
    await top(".result"),
    await top(".hand-panel"),
    await top("#inputs"),
  ];
  assert.deepEqual(
    order,
    [...order].sort((a, b) => a - b),
  );
  const heights = await page
    .locator("main button:not(.tip), main .button, main select")
    .evaluateAll((all) =>
      all.filter((one) => one.checkVisibility()).map((one) => [one.textContent, one.getBoundingClientRect().height]),
    );
  for (const [name, height] of heights) assert.ok((height as number) >= 43.5, `${name} is ${height} pixels high`);
  // Choosing files, the scene, the result and the decision take one and a half screens.
  for (const part of [".drop", ".space .view-host", "#dimensions", "#confidence", "#accept", ".image .view-host"]) {
    const box = await page.locator(part).boundingBox();
    assert.ok(box !== null && box.y + box.height < 1.5 * 844, `${part} ends at ${box && box.y + box.height}`);
  }
  // The run bar stays in sight while the page is scrolled.
  await page.mouse.wheel(0, 2000);
  const bar = await page.locator(".run").boundingBox();
  assert.ok(bar !== null && bar.y >= 0 && bar.y + bar.height <= 845, `the run bar is at ${bar?.y}`);
});
