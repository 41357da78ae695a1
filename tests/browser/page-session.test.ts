/** Nothing is lost: the scene, hand work and decisions survive a reload, and are saved and opened as one file. */
import assert from "node:assert/strict";
import { drop, files } from "../support/page-files.js";
import { PATIENCE, pageTests, type SitePage, until } from "../support/site.js";

const test = pageTests();

/** Opens own files, moves the mesh by hand, and accepts the pose. */
async function worked(opened: SitePage): Promise<string> {
  const { page } = opened;
  await drop(opened, files);
  await opened.shows("Own files");
  await page.click(".hand-panel .more summary");
  await opened.press("Move left");
  await page.check("#lock-scale");
  await opened.isNow("hand");
  await page.click("#accept");
  return (await page.textContent("#centre")) ?? "";
}

/** Whether leaving the page would ask. */
const asks = ({ page }: SitePage) =>
  page.evaluate(() => !dispatchEvent(new Event("beforeunload", { cancelable: true })));

/** Waits until the browser has kept everything. */
const kept = (opened: SitePage) =>
  until(
    () => asks(opened),
    (isOpen) => !isOpen,
  );

/** That the scene is as `worked` has left it. */
async function isAsLeft(opened: SitePage, centre: string): Promise<void> {
  const { page } = opened;
  await page.locator('main[data-scene="Own files"]').waitFor(PATIENCE);
  await opened.isNow("hand");
  assert.equal(await page.textContent("#centre"), centre);
  assert.ok(await page.isChecked("#lock-scale"));
  assert.match((await page.textContent("#accept")) ?? "", /Accepted/);
  assert.ok((await opened.metric("iou")) > 0.3);
}

test("a reload restores the scene, the pose and the decision; unstored work asks before it is left", async (opened, page) => {
  const centre = await worked(opened);
  await kept(opened);
  // Changes of this moment are not stored yet.
  await opened.press("Move right");
  await page.click("#undo");
  await page.click("#accept");
  await kept(opened);
  await page.reload();
  await isAsLeft(opened, centre);
  // The restored scene can be aligned, and its files can be changed.
  await page.click("#align");
  await opened.aligned();
  await page.click("#edit-files");
  await opened.sheet();
  await page.click("#intake-cancel");
  await page.click("#forget");
  await page.locator('main[data-scene="Table"]').waitFor(PATIENCE);
  await page.reload();
  await opened.shows("Table");
});

test("a session is saved and opened as one file", async (opened) => {
  const centre = await worked(opened);
  const { name, bytes } = await opened.saved("Session");
  assert.equal(name, "own-files.sim3align.zip");
  await opened.choose("#sample", "mug");
  await opened.shows("Mug");
  await drop(opened, { [name]: bytes });
  await isAsLeft(opened, centre);
});
