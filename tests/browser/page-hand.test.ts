/** By hand: nudges, a known size, refine, undo and redo. */
import assert from "node:assert/strict";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

const showNudges = ({ page }: SitePage) => page.click(".hand-panel .more summary");

test("nudges change the pose, with undo and redo", async (opened, page) => {
  const iou = await opened.metric("iou");
  await showNudges(opened);
  const names = ["Move left", "Move up", "Rotate clockwise"];
  for (const name of names) await page.getByRole("button", { name, exact: true }).click();
  await opened.isNow("hand");
  const moved = await opened.metric("iou");
  assert.ok(moved < iou, `${moved} is not below ${iou}`);
  await page.click("#undo");
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await opened.isNow("aligned");
  assert.equal(await opened.metric("iou"), iou);
  for (const _ of names) await page.click("#redo");
  await opened.isNow("hand");
  assert.equal(await opened.metric("iou"), moved);
  assert.equal(await page.getAttribute("#redo", "aria-disabled"), "true");
});

test(
  "undoing an alignment restores the confidence and the alternatives of the one before",
  "#sample=desk",
  async (opened, page) => {
    const confidence = () => page.textContent(".badge");
    const pictures = page.locator(".alternatives button");
    const before = [await confidence(), await pictures.count()];
    await opened.choose("#effort", "fast");
    await page.click(".options-panel summary");
    await opened.choose("#option-symmetry", "none");
    await opened.press("Align this object");
    await page.locator("#cancel").waitFor({ state: "detached" });
    await opened.aligned();
    const after = [await confidence(), await pictures.count()];
    assert.notDeepEqual(after, before);
    await page.click("#undo");
    assert.deepEqual([await confidence(), await pictures.count()], before);
    await page.click("#redo");
    assert.deepEqual([await confidence(), await pictures.count()], after);
  },
);

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

test("refining restores a mesh that was moved", async (opened, page) => {
  const iou = await opened.metric("iou");
  await showNudges(opened);
  await opened.press("Move right");
  await page.getByRole("button", { name: "Larger" }).click();
  await opened.isNow("hand");
  await page.click("#refine");
  await opened.isNow("refined");
  const refined = await opened.metric("iou");
  assert.ok(refined > iou - 0.02, `${refined}, was ${iou}`);
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

test("buttons keep the focus while they work, and when there is nothing left to redo", async (opened, page) => {
  const focused = () => page.evaluate(() => document.activeElement?.id);
  await page.focus("#refine");
  await page.keyboard.press("Enter");
  await opened.isNow("refined");
  assert.equal(await focused(), "refine");
  await page.keyboard.press("Control+z");
  await opened.isNow("aligned");
  await page.focus("#redo");
  await page.keyboard.press("Enter");
  await opened.isNow("refined");
  assert.equal(await focused(), "redo");
  assert.equal(await page.getAttribute("#redo", "aria-disabled"), "true");
});
