/** Videos: frames in folders are tracked through, shown on a time axis, and corrected in the middle. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { npy, obj } from "../support/files.js";
import {
  cameraFile,
  dropFolder,
  type Files,
  HEIGHT,
  jsonFile,
  maskPng,
  pinhole,
  WIDTH,
} from "../support/page-files.js";
import { mesh, type Pose, render, truth } from "../support/scene.js";
import { PATIENCE, type SitePage, SiteTest } from "../support/site.js";

let site: SiteTest;
before(async () => {
  site = await SiteTest.start(["!--enable-unsafe-webgpu"]);
});
after(() => site?.stop());

const COUNT = 5;

/** The pose in a frame: the object moves aside, 2 % of its distance from frame to frame. */
function poseIn(frame: number): Pose {
  const [x, y, z] = truth.translation;
  return { ...truth, translation: [x + 0.02 * z * (frame - (COUNT - 1) / 2), y, z] };
}

/** The folders of the frames. */
function frames(hasMasks: boolean): Files {
  const files: Files = { "toy/mesh.obj": obj(mesh) };
  for (let i = 0; i < COUNT; i++) {
    const seen = render(mesh, poseIn(i), pinhole, WIDTH, HEIGHT);
    const folder = `toy/frame_0${i}/`;
    files[`${folder}depth.npy`] = npy(seen.depth, HEIGHT, WIDTH);
    files[`${folder}camera.json`] = cameraFile;
    // The camera moves along; the world is that of the first frame.
    const rows = [
      [1, 0, 0, 0.01 * i],
      [0, 1, 0, 0],
      [0, 0, 1, 0],
      [0, 0, 0, 1],
    ];
    files[`${folder}pose.json`] = jsonFile({ camera_to_world: rows });
    if (hasMasks || i === 0) files[`${folder}mask.png`] = maskPng(seen.mask);
  }
  return files;
}

/** The x of the object's centre, metres. */
async function centreX({ page }: SitePage): Promise<number> {
  return Number.parseFloat((await page.textContent("#centre")) ?? "");
}

async function goTo({ page }: SitePage, frame: number): Promise<void> {
  await page.locator("#frame").fill(`${frame}`);
  await page.locator("#frame-name", { hasText: `${frame + 1}/${COUNT}` }).waitFor(PATIENCE);
}

for (const hasMasks of [true, false]) {
  test(`a video ${hasMasks ? "with masks" : "with one mask"} is tracked by itself`, async () => {
    const opened = await site.open();
    const { page } = opened;
    await dropFolder(opened, frames(hasMasks));
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
    await opened.close();
  });
}

test("a correction in the middle is carried to the other frames, and all poses are saved", async () => {
  const opened = await site.open();
  const { page } = opened;
  await dropFolder(opened, frames(true));
  await opened.says(/^Tracked/);
  await goTo(opened, 4);
  const before = await centreX(opened);
  await goTo(opened, 2);
  assert.ok(await page.isDisabled("#correct"));
  await page.click(".hand-panel .more summary");
  for (let i = 0; i < 4; i++) await page.getByRole("button", { name: "Move right", exact: true }).click();
  await opened.isNow("hand");
  await page.click("#correct");
  await opened.says(/^Corrected \d frames/);
  assert.equal(await page.locator('.strip [data-state="corrected"]').count(), 1);
  await goTo(opened, 4);
  assert.ok((await centreX(opened)) > before + 0.001, `${await centreX(opened)}, was ${before}`);
  const { name, bytes } = await opened.saved("JSON of all frames");
  assert.equal(name, "toy-frames.json");
  const { toy } = JSON.parse(`${bytes}`) as { toy: { frames: Record<string, { scale: number }> } };
  assert.equal(Object.keys(toy.frames).length, COUNT);
  // Another scene ends the video.
  await page.selectOption("#sample", "mug");
  await opened.shows("Mug");
  assert.equal(await page.locator(".time").count(), 0);
  await opened.close();
});

test("images without names of frames are scenes of their own, unless a click makes them one video", async () => {
  const opened = await site.open();
  const { page } = opened;
  const named = Object.entries(frames(true)).map(([path, bytes]) => [path.replace(/frame_0(\d)/, "view-$1"), bytes]);
  await dropFolder(opened, Object.fromEntries(named));
  await opened.sheet();
  assert.equal(await page.locator("#scene-choice option").count(), COUNT);
  assert.equal(await page.isChecked("#as-video"), false);
  await page.check("#as-video");
  await opened.sheet();
  await page.click("#intake-open");
  await opened.says(/^Tracked/);
  await opened.close();
});

test("frames of known cameras are aligned together, as views of an object that has not moved", async () => {
  const opened = await site.open();
  const { page } = opened;
  const views = frames(true);
  // The object moves in the camera as the camera moves the other way.
  for (let i = 0; i < COUNT; i++) {
    const [x, , , t] = [1, 0, 0, -0.02 * truth.translation[2] * i];
    const rows = [
      [x, 0, 0, t],
      [0, 1, 0, 0],
      [0, 0, 1, 0],
      [0, 0, 0, 1],
    ];
    views[`toy/frame_0${i}/pose.json`] = jsonFile({ camera_to_world: rows });
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
  await opened.close();
});

test("tracking can be stopped", async () => {
  const opened = await site.open();
  const { page } = opened;
  await opened.closeWorkerGate();
  await dropFolder(opened, frames(true));
  await page.locator("#stop-tracking").click(PATIENCE);
  await opened.openWorkerGate();
  await page.locator("#track").waitFor(PATIENCE);
  await opened.close();
});
