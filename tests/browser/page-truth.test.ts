/** What the page says is so: sizes along an object's own sides, and why mask and mesh differ. */
import assert from "node:assert/strict";
import { obj, png } from "../support/files.js";
import { depthNpy, drop, files, HEIGHT, maskPng, pinhole, seen, WIDTH } from "../support/page-files.js";
import { cuboid, render, transformed, truth } from "../support/scene.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

/** A box of sugar, in metres. */
const SIDES_M = [0.045, 0.092, 0.176] as const;
const box = cuboid(SIDES_M[0] / 2, SIDES_M[1] / 2, SIDES_M[2] / 2);

/** The same in a file whose axes are tilted against its sides, in another unit, as generated meshes are. */
const tilted = {
  positions: Float32Array.from(
    transformed(box.positions, { ...truth, scale: 7, rotation: [0.42, 0.36, -0.18, 0.814], translation: [1, 2, 3] }),
  ),
  indices: box.indices,
};

const sorted = (sides: readonly number[]) => [...sides].sort((a, b) => a - b);

test("sizes are those of the object's sides, in a file of any axes", async (opened, page) => {
  const view = render(box, { ...truth, scale: 1 }, pinhole, WIDTH, HEIGHT);
  await drop(opened, {
    ...files,
    "depth.npy": depthNpy(view.depth),
    "mask.png": maskPng(view.mask),
    "mesh.obj": obj(tilted),
  });
  await opened.shows("Own files");
  const sides = sorted(await opened.dimensions());
  for (const [k, side] of SIDES_M.entries()) {
    assert.ok(Math.abs((sides[k] ?? 0) / (100 * side) - 1) < 0.04, `${sides}, true are ${SIDES_M}`);
  }
  const json = JSON.parse(`${(await opened.saved("JSON")).bytes}`) as Record<string, { sizeM: number[] }>;
  const saved = sorted(Object.values(json)[0]?.sizeM ?? []);
  for (const [k, side] of saved.entries()) assert.ok(Math.abs(100 * side - (sides[k] ?? 0)) < 0.06, `${saved}`);
  // The length of another edge, or a wrong number, changes nothing unless a person takes it.
  const before = await opened.dimensions();
  const trial = page.locator(".hand-panel .trial");
  await opened.enter("#known-size", "25");
  await trial.locator("p", { hasText: "fits worse" }).waitFor(PATIENCE);
  assert.deepEqual(await opened.dimensions(), before);
  await opened.press("Keep the old");
  assert.deepEqual(await opened.dimensions(), before);
  assert.equal(await opened.source(), "aligned");
  assert.equal(await page.inputValue("#known-size"), Math.max(...before).toFixed(1));
  // A known edge leaves the others in proportion.
  await page.selectOption('.hand-panel [aria-label="Edge"]', "1");
  await opened.enter("#known-size", "9.3");
  await trial.locator("p", { hasText: "The mesh fits" }).waitFor(PATIENCE);
  await opened.press("Use");
  const known = sorted(await opened.dimensions());
  for (const [k, side] of SIDES_M.entries())
    assert.ok(Math.abs((known[k] ?? 0) * (0.092 / 9.3) - side) < 0.002, `${known}`);
  assert.ok(await page.isChecked("#lock-scale"));
});

/** The cause that the page names, and its sentence. */
const advice = async ({ page }: SitePage) => {
  const sentence = page.locator(".advice");
  await sentence.waitFor(PATIENCE);
  return `${await sentence.getAttribute("data-cause")}: ${await sentence.textContent()}`;
};

test("only what stands in front of an object explains a low overlap", "#sample=occluded", async (opened, page) => {
  assert.match(await advice(opened), /^occluded: .*\d+ % of the object is behind something else/);
  // Dragged behind the wall, the object is hidden as well, but not where it was seen.
  await page.click(".hand-panel .more summary");
  await page.fill("#centre-z", "500");
  await page.press("#centre-z", "Enter");
  await opened.isNow("hand");
  await page.locator('.advice[data-cause="moved"]').waitFor(PATIENCE);
  assert.equal(await page.textContent(".badge"), "Moved by hand");
  await opened.press("Back to the result");
  await opened.isNow("aligned");
});

test("a mask that shows a bare surface is named", async (opened, page) => {
  // A patch of the wall, which is not quite parallel to the image: its mask shows no object at all.
  const depth = seen.depth.map((z, i) => (z === 1.5 ? 1 / (1 / z + 0.0006 * (i % WIDTH)) : z));
  const mask = new Uint8Array(WIDTH * HEIGHT);
  for (let v = 8; v < 40; v++) mask.fill(1, v * WIDTH + 8, v * WIDTH + 48);
  await drop(opened, { ...files, "depth.npy": depthNpy(depth), "mask.png": maskPng(mask) });
  await page.locator('main[data-scene="Own files"]').waitFor(PATIENCE);
  assert.match(await advice(opened), /^mask: .*flat surface/);
});

test("relative depth that is passed as metres is named", async (opened, page) => {
  // Depth of the shape that depth models return, passed as metres.
  const relative = seen.depth.map((z) => (z > 0 ? 0.05 + 2 * (z - 0.6) : 0));
  await drop(opened, { ...files, "depth.npy": depthNpy(relative) });
  await page.locator('.advice[data-cause="relative"]').waitFor(PATIENCE);
  await page.locator(".advice button").click();
  await opened.sheet();
  await page.click("#intake-cancel");
});

test("a unit that was assumed is asked about, where the object would be as large as furniture", async (opened, page) => {
  // 5000 units per metre, as some datasets have, are taken for millimetres.
  const depth = png(
    Uint16Array.from(seen.depth, (z) => Math.round(5000 * z)),
    WIDTH,
    HEIGHT,
  );
  const { "depth.npy": _, ...rest } = files;
  await drop(opened, { ...rest, "depth.png": depth });
  assert.match(await advice(opened), /^unit: Is it really .* cm across and 3\.\d m away\? .* was assumed: 0\.001 m/);
  // A unit that was given is not asked about.
  await opened.press("Change the unit …");
  await opened.sheet();
  await page.selectOption("#depth-scale", "0.0002");
  await opened.sheet();
  await page.click("#intake-open");
  await page.locator(".advice").waitFor({ state: "detached", ...PATIENCE });
});
