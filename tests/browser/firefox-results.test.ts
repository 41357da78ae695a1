/** The page in Firefox: what it says is so, files are understood or named, and nothing is cut. */
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { repository } from "../support/environment.js";
import { setWindow } from "../support/firefox.js";
import { type FirefoxPage, firefoxTests } from "../support/firefox-page.js";
import { cutParts, screens } from "../support/layout.js";
import {
  bareWall,
  COUNT,
  depthInUnits,
  frames,
  hugeMesh,
  jpegOf,
  otherCamera,
  photoPng,
  relativeDepth,
  SIDES_M,
  tiltedBox,
  zipped,
} from "../support/page-cases.js";
import { type Files, files, HEIGHT, maskPng, seen, WIDTH } from "../support/page-files.js";

const test = firefoxTests();

const sorted = (sides: readonly number[]) => [...sides].sort((a, b) => a - b);

test("in Firefox, sizes are those of the object's sides, and a wrong one changes no pose", async (opened) => {
  await opened.drop(tiltedBox());
  await opened.shows("Own files");
  const before = await opened.dimensions();
  for (const [k, side] of sorted(before).entries())
    assert.ok(Math.abs(side / (100 * (SIDES_M[k] ?? 0)) - 1) < 0.04, `${before}, true are ${SIDES_M}`);
  const [one] = Object.values(JSON.parse(await opened.saved("JSON")) as Record<string, { sizeM: number[] }>);
  for (const [k, side] of (one?.sizeM ?? []).entries()) assert.ok(Math.abs(100 * side - (before[k] ?? 0)) < 0.06);
  await opened.enter("#known-size", "25");
  await opened.has(".hand-panel .trial p", /fits worse/);
  assert.deepEqual(await opened.dimensions(), before);
  await opened.press("Keep the old");
  await opened.hasNo(".trial");
  assert.deepEqual(await opened.dimensions(), before);
  await opened.isNow("aligned");
});

test("in Firefox, a pose by hand has no confidence of a search, and undo restores it", async (opened) => {
  const confidence = () => opened.text(".badge");
  const before = await confidence();
  await opened.press("Move left");
  await opened.has(".badge", /^Moved by hand$/);
  await opened.click("#undo");
  await opened.isNow("aligned");
  assert.equal(await confidence(), before);
  // In a video, it is said to be set by hand.
  await opened.drop(zipped(frames(true)));
  await opened.says(new RegExp(`^Tracked ${COUNT} frames`));
  await opened.press("Previous frame");
  await opened.has("#frame-name", new RegExp(`^${COUNT - 1}/`));
  for (let i = 0; i < 4; i++) await opened.press("Move right");
  await opened.isNow("hand");
  await opened.click("#correct");
  await opened.says(/^Corrected \d frames/);
  await opened.has("#frame-name", /corrected$/);
  assert.equal(await confidence(), "Set by hand");
});

const desk = { address: "#sample=desk&symmetry=none" };
test(
  "in Firefox, what is refined from afar has the confidence and alternatives of its own pose",
  desk,
  async (opened) => {
    type Shown = { translation: number[]; confidence: number | null; source: string };
    const shown = async () => {
      await opened.metric("iou");
      const [one] = Object.values(JSON.parse(await opened.saved("JSON")) as Record<string, Shown>);
      const [badge, alternatives] = [await opened.text(".badge"), await opened.texts(".alternatives button")];
      return { ...(one as Shown), badge, alternatives };
    };
    const found = await shown();
    assert.ok(found.alternatives.length > 1);
    // By 15 cm.
    const x = await opened.page.$eval("#centre-x", (one) => (one as HTMLInputElement).valueAsNumber);
    await opened.enter("#centre-x", `${x + 15}`);
    await opened.has(".badge", /^Moved by hand$/);
    const moved = await shown();
    assert.deepEqual([moved.confidence, moved.source], [null, "hand"]);
    await opened.click("#refine");
    await opened.isNow("refined");
    const refined = await shown();
    const offM = Math.hypot(...refined.translation.map((at, k) => at - (found.translation[k] ?? 0)));
    assert.ok(offM < 0.01 || (refined.confidence ?? 1) < 0.7, `${refined.badge}, ${offM} m off`);
    assert.ok(refined.badge.startsWith(`${Math.round(100 * (refined.confidence ?? 0))} %`));
    for (const before of [moved, found]) {
      await opened.click("#undo");
      assert.deepEqual(await shown(), before);
    }
  },
);

/** Waits for the cause that the page names, and its sentence. */
const advises = (opened: FirefoxPage, cause: string, says: RegExp) =>
  opened.has(`.advice[data-cause="${cause}"]`, says);

test("in Firefox, a unit that was assumed is asked about", async (opened) => {
  for (const perMetre of [5000, 10_000]) {
    await opened.drop(depthInUnits(perMetre));
    await advises(opened, "unit", /Is it really .* cm across and \d\.\d m away\? .* was assumed: 0\.001 m/);
    await opened.has(".input-panel", /Unit\s*0\.001 m .*assumed/);
    await opened.click('[data-sample="hammer"]');
    await opened.shows("Hammer");
  }
});

test("in Firefox, the cause of what does not fit is named", async (opened) => {
  await opened.drop(bareWall());
  await advises(opened, "mask", /flat surface/);
  await opened.drop(relativeDepth());
  await advises(opened, "relative", /relative or inverted/);
  await opened.drop(files);
  await opened.shows("Own files");
  await opened.hasNo(".advice");
  // Dragged far behind the wall, the object is hidden as well, but not where it was seen.
  await opened.enter("#centre-z", "500");
  await advises(opened, "moved", /^Moved by hand/);
});

const occluded = { address: "#sample=occluded" };
test("in Firefox, an occluder and the mesh of another object are named", occluded, async (opened) => {
  await advises(opened, "occluded", /\d+ % of the object is behind something else/);
  const sample = async (name: string) => readFile(join(repository, "www", "samples", "hammer", name));
  const [depth, mask, camera] = await Promise.all(["depth.png", "mask.png", "camera.json"].map(sample));
  const hammer = { "depth.png": depth, "mask.png": mask, "camera.json": camera } as Files;
  await opened.drop({ ...hammer, "mesh.obj": files["mesh.obj"] as Uint8Array });
  await opened.shows("Own files");
  await advises(opened, "mesh", /probably that of another object/);
});

/** Drops files, waits for what the sheet says of a field, and closes the sheet. */
async function refuses(opened: FirefoxPage, dropped: Files, field: string, says: RegExp): Promise<void> {
  await opened.drop(dropped);
  await opened.has(`.intake [role=alert][id^="${field}-error"]`, says);
  await opened.click("#intake-cancel");
  await opened.hasNo(".intake");
}

test("in Firefox, files are understood, or named with what helps", async (opened) => {
  const { "depth.npy": _, ...rest } = files;
  for (const name of ["scene.npz", "depth.exr", "depth.tiff"])
    await refuses(opened, { ...rest, [name]: Buffer.from("no depth") }, "depth", new RegExp(name));
  await refuses(opened, { ...files, "mask.exr": Buffer.from("v/1\x01") }, "files", /mask\.exr: not used/);
  await refuses(opened, hugeMesh(), "mesh", /17 000 000 triangles; expected at most 4 194 304/);
  await refuses(opened, otherCamera(2 * WIDTH, HEIGHT), "camera", /cropped or stretched/);
  await opened.isShown("Mug");
  // A camera of a resized image is scaled.
  await opened.drop(otherCamera(2 * WIDTH, 2 * HEIGHT));
  await opened.press("Scale it");
  await opened.shows("Own files");
  // Mask and mesh of an open scene may be its own.
  const { "mask.png": mask, "mesh.obj": mesh } = files as Record<"mask.png" | "mesh.obj", Uint8Array>;
  await opened.drop({ "mask.png": mask, "mesh.obj": mesh });
  await opened.has("#for-shown", /mask\.png, mesh\.obj: for Own files, or a new scene\?/);
  await opened.click("#put-into-shown");
  await opened.sheet();
  await opened.click("#intake-open");
  await opened.shows("Own files");
});

test("in Firefox, photo and mask are shown without depth, also if saved with losses", async (opened) => {
  const jpeg = async (image: Uint8Array) =>
    Buffer.from((await opened.page.evaluate(jpegOf(image))) as string, "base64");
  await opened.drop({ "IMG_0815.jpg": await jpeg(photoPng), "mask.jpg": await jpeg(maskPng(seen.mask)) });
  await opened.has('[data-field="photo"]', /IMG_0815\.jpg.*320 × 240/);
  await opened.has('[data-field="photo"] canvas');
  await opened.has(".pair", /mask\.jpg/);
  await opened.has(".pair canvas");
});

test("in Firefox, nothing is cut on any screen, and the decision is in sight", { address: "" }, async (opened) => {
  for (const [width, height] of screens) {
    await setWindow(opened.page, width, height);
    assert.deepEqual(await opened.page.evaluate(cutParts), [], `${width} × ${height}`);
    const ends = await opened.page.evaluate(() =>
      [".drop", "#dimensions", "#accept"].map((part) => document.querySelector(part)?.getBoundingClientRect().bottom),
    );
    for (const end of ends) assert.ok(end !== undefined && end < 1.5 * height, `${ends} at ${width} × ${height}`);
  }
  // At the end named "After", the wipe shows the pose after.
  assert.equal(await opened.page.$eval("#wipe", (one) => (one as HTMLInputElement).value), "1");
  await opened.page.keyboard.press("b");
  assert.equal(await opened.page.$eval("#wipe", (one) => (one as HTMLInputElement).value), "0");
});
