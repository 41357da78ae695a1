/** The views: framing, ground, keyboard, measuring, before and after, numbers, wheel and drag in the image. */
import assert from "node:assert/strict";
import { WEBGL } from "../support/browser.js";
import { depthNpy, dropFolder, files, HEIGHT, inFolder, pinhole, WIDTH } from "../support/page-files.js";
import { mesh, render, truth } from "../support/scene.js";
import { pageTests, type SitePage, spacePixels, until } from "../support/site.js";

const test = pageTests(WEBGL);

/** The box of the pixels that differ from the background, as shares of the view: left, top, right, bottom. */
async function drawn({ page }: SitePage): Promise<[number, number, number, number]> {
  const { width, height, data } = await spacePixels(page);
  let [left, top, right, bottom] = [1, 1, 0, 0];
  // Without the border, which may cover a part of a pixel.
  const edge = 3;
  const ground = 4 * (edge * width + edge);
  for (let i = 0; i < width * height; i++) {
    const [x, y] = [i % width, Math.floor(i / width)];
    if (x < edge || y < edge || x >= width - edge || y >= height - edge) continue;
    if ([0, 1, 2].every((k) => Math.abs((data[4 * i + k] ?? 0) - (data[ground + k] ?? 0)) <= 24)) continue;
    [left, right] = [Math.min(left, x / width), Math.max(right, x / width)];
    [top, bottom] = [Math.min(top, y / height), Math.max(bottom, y / height)];
  }
  return [left, top, right, bottom];
}

/** What is wrong with where an object is drawn. */
function faultOf(box: [number, number, number, number]): string | null {
  const [left, top, right, bottom] = box;
  const text = box.map((x) => x.toFixed(2)).join(", ");
  if (bottom - top < 0.25 && right - left < 0.25) return `small: ${text}`;
  if (left < 0.02 || top < 0.02 || right > 0.98 || bottom > 0.98) return `cut: ${text}`;
  const isAside = Math.abs((left + right) / 2 - 0.5) > 0.25 || Math.abs((top + bottom) / 2 - 0.5) > 0.25;
  return isAside ? `aside: ${text}` : null;
}

test("objects of every size and distance are framed, before and after an alignment", {
  reducedMotion: "reduce",
}, async (opened) => {
  await opened.has3d("webgl");
  for (const name of ["Points", "Sizes"]) await opened.show3d(name, false);
  for (const factor of [1, 30, 0.1]) {
    if (factor !== 1) {
      const pose = { ...truth, scale: factor * truth.scale, translation: truth.translation.map((x) => factor * x) };
      const seen = render(mesh, pose as typeof truth, pinhole, WIDTH, HEIGHT, 1.5 * factor);
      const name = `times ${factor}`;
      await dropFolder(opened, inFolder(name, { ...files, "depth.npy": depthNpy(seen.depth) }));
      await opened.shows(name);
    }
    for (const from of ["Camera", "Three-quarter", "Top", "Side"]) {
      await opened.press(from);
      const fault = async () => {
        const wrong = faultOf(await drawn(opened));
        return wrong && `${factor} × the size from ${from}: ${wrong}`;
      };
      await until(fault, (found) => found === null);
    }
  }
});

test("two clicks measure a distance", async (opened, page) => {
  await opened.has3d("webgl");
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
