/** By hand: nudges, a known size, refine, undo and redo. */
import assert from "node:assert/strict";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

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
  await opened.click("#lock-scale");
  await page.click("#align");
  await page.locator("#cancel").waitFor({ state: "detached" });
  await opened.aligned();
  assert.equal(await longest(), before);
});
