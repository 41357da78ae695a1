/** The views: framing, ground, keyboard, measuring, before and after, numbers, wheel and drag in the image. */
import assert from "node:assert/strict";
import { WEBGL } from "../support/browser.js";
import { PATIENCE, pageTests } from "../support/site.js";

const test = pageTests(WEBGL);

test("two clicks measure a distance", async (opened, page) => {
  await page.locator('.view-host[data-backend="webgl"] canvas').waitFor(PATIENCE);
  await opened.press("Measure");
  assert.match((await page.textContent("#measured")) ?? "", /Click a point/);
  const canvas = page.locator(".image canvas");
  const { width, height } = (await canvas.boundingBox()) ?? { width: 0, height: 0 };
  await canvas.click({ position: { x: 0.5 * width, y: 0.45 * height } });
  await canvas.click({ position: { x: 0.5 * width, y: 0.55 * height } });
  const length = Number.parseFloat((await page.textContent("#measured")) ?? "");
  assert.ok(length > 0.5 && length < 12, `${length} cm on a mug`);
  await opened.press("Measure");
  assert.equal(await page.locator("#measured").count(), 0);
});

test("the pose is entered in numbers, as steps that can be undone", async (opened, page) => {
  await page.click(".hand-panel .more summary");
  const at = Number(await page.inputValue("#centre-x"));
  await page.fill("#centre-x", `${at + 2}`);
  await page.press("#centre-x", "Enter");
  await opened.isNow("hand");
  assert.ok(Math.abs(Number(await page.inputValue("#centre-x")) - at - 2) < 0.011);
  const rotation = await page.textContent("#rotation");
  await page.fill("#turn-deg", "90");
  await page.press("#turn-deg", "Enter");
  await page.waitForFunction((old) => document.querySelector("#rotation")?.textContent !== old, rotation);
  assert.ok(Math.abs(Number(await page.inputValue("#centre-x")) - at - 2) < 0.011, "a turn moves the centre");
  await page.click("#undo");
  await page.click("#undo");
  await opened.isNow("aligned");
  assert.equal(Number(await page.inputValue("#centre-x")), at);
});
