/** Videos: frames in folders are tracked through, shown on a time axis, and corrected in the middle. */
import assert from "node:assert/strict";
import { WEBGL } from "../support/browser.js";
import { glbJson } from "../support/files.js";
import { COUNT, cameraAt, dropFolder, frames, poseIn } from "../support/page-files.js";
import { truth } from "../support/scene.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

const TRACKS = ["translation", "rotation", "scale"];

/** The x of the object's centre, metres. */
async function centreX({ page }: SitePage): Promise<number> {
  return Number.parseFloat((await page.textContent("#centre")) ?? "");
}

async function goTo({ page }: SitePage, frame: number): Promise<void> {
  await page.locator("#frame").fill(`${frame}`);
  await page.locator("#frame-name", { hasText: `${frame + 1}/${COUNT}` }).waitFor(PATIENCE);
}

// The 3D view shows each frame.
pageTests(WEBGL)("a video with one mask is tracked by itself", async (opened, page) => {
  await dropFolder(opened, frames(false));
  await opened.says(new RegExp(`^Tracked ${COUNT} frames`));
  assert.equal(await page.locator('.strip [data-state="tracking"]').count(), COUNT);
  assert.match((await page.textContent("#result-title")) ?? "", /toy/);
  for (const frame of [COUNT - 1, 0]) {
    await goTo(opened, frame);
    const expected = 0.02 * truth.translation[2] * (COUNT - 1);
    const moved = frame === 0 ? 0 : expected;
    const first = poseIn(0).translation[0];
    const x = await centreX(opened);
    assert.ok(Math.abs(x - first - moved) < 0.3 * expected, `frame ${frame}: ${x}, first ${first}`);
  }
  assert.deepEqual(await opened.violations(), []);
});

test("a correction in the middle is carried to the other frames, and all poses are saved", async (opened, page) => {
  await dropFolder(opened, frames(true));
  await opened.says(/^Tracked/);
  await goTo(opened, 4);
  const before = await centreX(opened);
  await goTo(opened, 2);
  assert.ok(await page.isDisabled("#correct"));
  await page.click(".hand-panel .more summary");
  for (let i = 0; i < 4; i++) await opened.press("Move right");
  await opened.isNow("hand");
  await page.click("#correct");
  await opened.says(/^Corrected \d frames/);
  assert.equal(await page.locator('.strip [data-state="corrected"]').count(), 1);
  // Nobody knows how sure a pose is that a person has set.
  assert.equal(await page.textContent(".badge"), "Set by hand");
  assert.match((await page.textContent("#frame-name")) ?? "", /corrected$/);
  await goTo(opened, 4);
  assert.ok((await centreX(opened)) > before + 0.001, `${await centreX(opened)}, was ${before}`);
  const { name, bytes } = await opened.saved("JSON of all frames");
  assert.equal(name, "toy-frames.json");
  const { toy } = JSON.parse(`${bytes}`) as { toy: { frames: Record<string, { scale: number }> } };
  assert.equal(Object.keys(toy.frames).length, COUNT);
  const { animations, accessors } = glbJson((await opened.saved("Animated GLB")).bytes);
  const { channels, samplers } = animations[0];
  assert.deepEqual(
    channels.map(({ target, sampler }: { target: { path: string }; sampler: number }) => [
      target.path,
      accessors[samplers[sampler].output].count,
    ]),
    // Of the object, and of the camera, whose poses are known.
    [...TRACKS, ...TRACKS].map((path) => [path, COUNT]),
  );
  // Another scene ends the video.
  await opened.sample("mug");
  await opened.shows("Mug");
  assert.equal(await page.locator(".time").count(), 0);
});

test("frames of known cameras are aligned together, as views of an object that has not moved", async (opened, page) => {
  const views = frames(true);
  // The object moves in the camera as the camera moves the other way.
  for (let i = 0; i < COUNT; i++) {
    views[`toy/frame_0${i}/pose.json`] = cameraAt(-0.02 * truth.translation[2] * i);
  }
  await dropFolder(opened, views);
  await opened.says(/^Tracked/);
  await page.click("#align-frames");
  await opened.says(new RegExp(`^Aligned ${COUNT} views together, (9\\d|100) %`));
  const step = 0.02 * truth.translation[2];
  await goTo(opened, 0);
  const first = await centreX(opened);
  await goTo(opened, COUNT - 1);
  const last = await centreX(opened);
  // One pose in the world: the views differ exactly as their cameras do.
  assert.ok(Math.abs(last - first - step * (COUNT - 1)) < 0.0011, `from ${first} to ${last}, steps of ${step}`);
});

test("a video and what was accepted in it survive another one, and a reload", async (opened, page) => {
  await dropFolder(opened, frames(true));
  await opened.says(/^Tracked/);
  await goTo(opened, 2);
  await page.click("#accept");
  // The next one comes by itself.
  await page.locator("#frame-name", { hasText: `4/${COUNT}` }).waitFor(PATIENCE);
  await goTo(opened, 2);
  const centre = await page.textContent("#centre");
  const isAsLeft = async () => {
    await page.locator("#frame-name", { hasText: `3/${COUNT}` }).waitFor(PATIENCE);
    await page.locator("#centre", { hasText: centre ?? "" }).waitFor({ ...PATIENCE, state: "attached" });
    assert.equal(await page.textContent("#accept"), "✓ Accepted");
    assert.equal(await page.locator('.strip [data-state="tracking"]').count(), COUNT);
  };
  const other = Object.entries(frames(true)).map(([path, bytes]) => [path.replace("toy", "other"), bytes] as const);
  await dropFolder(opened, Object.fromEntries(other));
  await page.locator("#frame-name", { hasText: `1/${COUNT}` }).waitFor(PATIENCE);
  await page.locator(".scenes button", { hasText: "toy" }).click();
  await isAsLeft();
  await opened.sample("mug");
  await opened.shows("Mug");
  await opened.kept();
  await page.reload();
  await opened.shows("Mug");
  await page.locator(".scenes button", { hasText: "toy" }).click();
  await isAsLeft();
});

test("names hold in all frames, keys go through them, and what was tracked is accepted at once", async (opened, page) => {
  await dropFolder(opened, frames(true));
  await opened.says(/^Tracked/);
  await opened.reveal(page.locator("#object-name"), async (field) => {
    await field.fill("My toy");
    // The panel is drawn again while the name is typed.
    for (const text of ["✓ Accepted", "Accept"]) {
      await page.evaluate(() => document.querySelector<HTMLElement>("#accept-tracked")?.click());
      await page.locator("#accept", { hasText: text }).waitFor(PATIENCE);
    }
    await field.press("Enter");
  });
  await page.evaluate(() => (document.activeElement as HTMLElement).blur());
  await page.keyboard.press("ArrowLeft");
  await page.locator("#frame-name", { hasText: `${COUNT - 1}/${COUNT}` }).waitFor(PATIENCE);
  assert.equal((await page.textContent("#result-title"))?.trim(), "My toy");
  await page.click("#accept-tracked");
  await opened.says(new RegExp(`^Accepted ${COUNT} frames`));
  assert.equal(await page.textContent("#accept"), "✓ Accepted");
  const { bytes } = await opened.saved("JSON of all frames");
  const saved = JSON.parse(`${bytes}`) as Record<string, { frames: Record<string, { decision: string | null }> }>;
  const decisions = Object.values(saved["My toy"]?.frames ?? {}).map(({ decision }) => decision);
  assert.deepEqual(decisions, Array(COUNT).fill("accepted"));
  await page.click("#accept-tracked");
  assert.equal(await page.textContent("#accept"), "Accept");
});

test("tracking that is left goes on with the video, however far it was", async (opened, page) => {
  await page.evaluate(() => {
    const status = document.querySelector("#status") as HTMLElement;
    const leave = new MutationObserver(() => {
      if (!/^Tracking frame 2/.test(status.textContent ?? "")) return;
      leave.disconnect();
      document.querySelector<HTMLElement>('[data-sample="mug"]')?.click();
    });
    leave.observe(status, { childList: true, characterData: true, subtree: true });
  });
  await dropFolder(opened, frames(true));
  await page.locator(".scenes button", { hasText: "toy" }).waitFor(PATIENCE);
  await page.locator('main[data-scene="Mug"]').waitFor(PATIENCE);
  await page.locator(".scenes button", { hasText: "toy" }).click();
  await page
    .locator('.strip [data-state="tracking"]')
    .nth(COUNT - 1)
    .waitFor({ ...PATIENCE, state: "attached" });
});
