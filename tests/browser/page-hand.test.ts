/** By hand: nudges, numbers, a known size, refine, undo and redo; measuring. */
import assert from "node:assert/strict";
import { PATIENCE, pageTests, type SitePage, until } from "../support/site.js";

const test = pageTests();

const showNudges = ({ page }: SitePage) => page.click(".hand-panel .more summary");

test("a decision is undone and redone with the pose it is about", async (opened, page) => {
  const text = async () => (await page.textContent("#accept")) ?? "";
  await page.click("#accept");
  assert.match(await text(), /Accepted/);
  await showNudges(opened);
  await opened.press("Move left");
  assert.equal(await text(), "Accept");
  await page.click("#undo");
  assert.match(await text(), /Accepted/);
  await opened.says(/^Undid the change of/);
  await page.click("#undo");
  assert.equal(await text(), "Accept");
  assert.equal(await opened.source(), "aligned");
  await page.click("#redo");
  assert.match(await text(), /Accepted/);
});

test("a known size is one step, and every alignment keeps it", async (opened, page) => {
  const longest = async () => Math.max(...(await opened.dimensions()));
  const before = await longest();
  const known = (0.97 * before).toFixed(1);
  await opened.enter("#known-size", known);
  await page.locator(".trial").waitFor(PATIENCE);
  assert.equal(await longest(), before);
  assert.deepEqual(await opened.violations(), []);
  await opened.press("Use");
  assert.equal(await longest(), Number(known));
  await page.click("#undo");
  assert.equal(await longest(), before);
  assert.ok(!(await page.isChecked("#lock-scale")));
  await page.click("#redo");
  assert.ok(await page.isChecked("#lock-scale"));
  await page.click("#refine");
  await opened.isNow("refined");
  assert.equal(await longest(), Number(known));
  await page.click("#align");
  await opened.isNow("aligned");
  assert.equal(await longest(), Number(known));
  // With a size that cannot be right, the search says so, and goes on without it.
  await opened.enter("#known-size", (1.6 * before).toFixed(1));
  await opened.press("Use");
  await page.locator('.advice[data-cause="size"] button', { hasText: "Search without this size" }).click(PATIENCE);
  await until(longest, (size) => size === before);
  assert.ok(!(await page.isChecked("#lock-scale")));
});

test("the pose is entered in numbers, as steps that can be undone", async (opened, page) => {
  await showNudges(opened);
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
