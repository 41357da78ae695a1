/** Nothing is lost: the scene, hand work and decisions survive a reload, and are saved and opened as one file. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { strFromU8, unzipSync } from "fflate";
import { drop, dropFolder, type Files, files, inFolder } from "../support/page-files.js";
import { PATIENCE, pageTests, SitePage, siteDir } from "../support/site.js";

const test = pageTests();

/** Opens own files, moves the mesh by hand, and accepts the pose. */
async function worked(opened: SitePage): Promise<string> {
  const { page } = opened;
  await drop(opened, files);
  await opened.shows("Own files");
  await page.click(".hand-panel .more summary");
  await opened.press("Move left");
  await opened.click("#lock-scale");
  await opened.isNow("hand");
  await page.click("#accept");
  return (await page.textContent("#centre")) ?? "";
}

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
  await opened.kept();
  // Changes of this moment are not stored yet.
  await opened.press("Move right");
  await page.click("#undo");
  await page.click("#accept");
  await opened.kept();
  await page.reload();
  await isAsLeft(opened, centre);
  // The restored scene can be aligned, and its files can be changed.
  await page.click("#align");
  await opened.aligned();
  await opened.click("#edit-files");
  await opened.sheet();
  await page.click("#intake-cancel");
  await page.click("#accept");
  // What was decided is not forgotten unasked.
  page.once("dialog", (dialog) => dialog.dismiss());
  await opened.click("#forget");
  assert.equal(await page.getAttribute("main", "data-scene"), "Own files");
  page.once("dialog", (dialog) => dialog.accept());
  await opened.click("#forget");
  await page.locator('main[data-scene="Kitchen"]').waitFor(PATIENCE);
  await page.reload();
  await opened.shows("Kitchen");
});

test("the ground that objects stand on is known again after a reload", async (opened, page) => {
  const desk = (name: string) => Uint8Array.from(readFileSync(join(siteDir, "samples", "desk", name)));
  const own: Files = { "depth.png": desk("depth.png"), "camera.json": desk("camera.json") };
  for (const object of ["animal", "box", "teapot"]) {
    own[`mask-${object}.png`] = desk(`${object}/mask.png`);
    own[`mesh-${object}.glb`] = desk(`${object}/mesh.glb`);
  }
  await drop(opened, own);
  await opened.shows("Own files");
  await page.click("#align-all");
  await page.locator(".sides", { hasText: "width × depth × height" }).waitFor(PATIENCE);
  const before = await opened.dimensions();
  await opened.kept();
  await page.reload();
  await page.locator('main[data-scene="Own files"]').waitFor(PATIENCE);
  // Another one may wait for a decision, and be selected.
  await page.locator(".objects .select").first().click();
  await page.locator(".sides", { hasText: "width × depth × height" }).waitFor(PATIENCE);
  assert.deepEqual(await opened.dimensions(), before);
});

test("a project is saved and opened as one file, with every scene, decision and name", async (opened, page) => {
  const centre = await worked(opened);
  const one = await opened.saved("Project");
  assert.equal(one.name, "own-files.sim3align.zip");
  await dropFolder(opened, inFolder("IMG_002--b", files));
  await opened.shows("IMG_002--b");
  const { name, bytes } = await opened.saved("Project");
  assert.equal(name, "project.sim3align.zip");
  const results = JSON.parse(strFromU8(unzipSync(bytes)["results.json"] as Uint8Array)) as Results;
  assert.deepEqual(Object.keys(results), ["Own files", "IMG_002--b"]);
  const [first, second] = Object.values(results).map(({ _about, ...objects }) => [_about, ...Object.values(objects)]);
  assert.deepEqual([first?.[1]?.decision, first?.[1]?.source], ["corrected", "hand"]);
  assert.deepEqual([second?.[1]?.decision, second?.[1]?.source], [null, "aligned"]);
  assert.deepEqual(second?.[1]?.files, { mask: "IMG_002--b/mask.png", mesh: "IMG_002--b/mesh.obj" });
  assert.deepEqual(second?.[0]?.depthUnit, { metres: 1, source: "float values", isAssumed: true });

  // In a browser that knows nothing of it.
  const other = await page.context().browser()?.newContext();
  const fresh = await other?.newPage();
  assert.ok(other !== undefined && fresh !== undefined);
  // Which scene is shown does not depend on how long each takes to read.
  await other.clock.setFixedTime(new Date());
  await fresh.goto(page.url());
  const there = new SitePage(fresh, []);
  await there.aligned();
  await drop(there, { [name]: bytes });
  await fresh.locator('main[data-scene="IMG_002--b"]').waitFor(PATIENCE);
  await fresh.locator(".scenes button", { hasText: "Own files" }).click();
  await isAsLeft(there, centre);
  await other.close();
});

/** The entries of results that are looked at. */
interface Entry {
  decision?: string | null;
  source?: string;
  files?: object;
  depthUnit?: object;
}
type Results = Record<string, Record<string, Entry>>;

test("a full disk is told, what was done can be saved, and room is used as soon as there is some", async (opened, page) => {
  const session = await page.context().newCDPSession(page);
  const { origin } = new URL(page.url());
  await session.send("Storage.overrideQuotaForOrigin", { origin, quotaSize: 1 });
  const centre = await worked(opened);
  await page.locator("#not-kept", { hasText: "storage is full: Own files is not kept" }).waitFor(PATIENCE);
  assert.ok(await opened.asks());
  assert.deepEqual(await opened.violations(), []);
  const [download] = await Promise.all([page.waitForEvent("download"), opened.press("Save the project")]);
  assert.equal(download.suggestedFilename(), "own-files.sim3align.zip");
  await session.send("Storage.overrideQuotaForOrigin", { origin });
  await opened.press("Move right");
  await page.click("#undo");
  await page.locator("#not-kept").waitFor({ state: "detached", ...PATIENCE });
  await opened.kept();
  await page.reload();
  await isAsLeft(opened, centre);
});
