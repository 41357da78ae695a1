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

/** Without animations. */
const still = { reducedMotion: "reduce" } as const;

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

test("the 3D view is orbited by keys, and shows the poses before", still, async (opened, page) => {
  await opened.has3d("webgl");
  await opened.press("Three-quarter");
  await page.locator(".space canvas").focus();
  const picture = async () => (await page.locator(".space .view-host").screenshot()).toString("base64");
  const first = await picture();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("+");
  const turned = await until(picture, (shown) => shown !== first);
  await opened.press("Before");
  await until(picture, (shown) => shown !== turned);
  assert.equal(await opened.source(), "aligned");
  await opened.press("Before");
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

test(
  "the wheel zooms the image at the pointer, and a drag moves it without selecting",
  "#sample=desk",
  async (opened, page) => {
    const picture = page.locator(".picture");
    const zoom = async () => Number(await picture.evaluate((one) => getComputedStyle(one).getPropertyValue("--zoom")));
    const x = async () => Number(await picture.evaluate((one) => getComputedStyle(one).getPropertyValue("--x")));
    await opened.showInImage("zoom", false);
    assert.equal(await zoom(), 1);
    const host = (await page.locator(".image .view-host").boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
    const [u, v] = [host.x + host.width / 2, host.y + host.height / 2];
    await page.mouse.move(u, v);
    await page.mouse.wheel(0, -800);
    await page.waitForFunction(
      () => Number(getComputedStyle(document.querySelector(".picture") as Element).getPropertyValue("--zoom")) > 2,
    );
    const before = await x();
    const chosen = await page.textContent(".objects [aria-pressed=true] .name");
    await page.mouse.down();
    await page.mouse.move(u - 60, v, { steps: 4 });
    await page.mouse.up();
    assert.ok((await x()) > before, `${await x()}, was ${before}`);
    assert.equal(await page.textContent(".objects [aria-pressed=true] .name"), chosen);
    await opened.showInImage("zoom", true);
  },
);

/** The number of pixels of the 3D view that differ from before once something is done. */
async function changedBy({ page }: SitePage, act: () => Promise<unknown>): Promise<number> {
  const still = async () => {
    // Until two pictures in a row are the same.
    let last = await spacePixels(page);
    for (;;) {
      const next = await spacePixels(page);
      if (last.data.equals(next.data)) return next;
      last = next;
    }
  };
  const before = await still();
  await act();
  const after = await still();
  let count = 0;
  for (let i = 0; i < after.data.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs((after.data[i + k] ?? 0) - (before.data[i + k] ?? 0)) > 8)) count++;
  }
  return count;
}

test("what is nearer hides a mesh in the view from the camera", still, async (opened, page) => {
  await opened.has3d("webgl");
  await opened.press("Camera");
  await opened.show3d("Sizes", false);
  const meshPixels = async () => {
    const count = await changedBy(opened, () => page.keyboard.press("m"));
    await page.keyboard.press("m");
    return count;
  };
  await page.click(".hand-panel .more summary");
  const read = async (id: string) => Number(await page.inputValue(id));
  const move = async (id: string, toCm: number) => {
    await page.fill(id, `${toCm}`);
    await page.press(id, "Enter");
    await page.locator("h1").click();
  };
  // Beside its mask, where the table and the wall are the scene.
  const [x, y, z] = [await read("#centre-x"), await read("#centre-y"), await read("#centre-z")];
  await move("#centre-x", x + 7);
  const beside = await meshPixels();
  assert.ok(beside > 500, `${beside} pixels of the mesh`);
  // At the same place in the image, three metres farther away.
  await move("#centre-x", ((x + 7) * (z + 300)) / z);
  await move("#centre-y", (y * (z + 300)) / z);
  await move("#centre-z", z + 300);
  const behind = await meshPixels();
  assert.ok(behind < beside / 50, `${behind} pixels of a mesh behind the wall, ${beside} in front of it`);
});

test("labels leave the handles free", still, async (opened, page) => {
  await opened.has3d("webgl");
  await opened.press("Camera");
  // Without the pointer, which would mark what it hovers over.
  const box = page.locator(".space").getByLabel("Sizes", { exact: true });
  const toggle = () => box.evaluate((one) => (one as HTMLElement).click());
  assert.ok((await changedBy(opened, toggle)) > 100);
  await toggle();
  await page.keyboard.press("g");
  assert.equal(await changedBy(opened, toggle), 0);
});

test("the wipe shows at each end what is written there", async (opened, page) => {
  const picture = async () => (await opened.imagePixels()).data;
  const after = await picture();
  assert.equal(await page.inputValue("#wipe"), "1");
  await page.fill("#wipe", "0");
  const before = await picture();
  assert.ok(!before.equals(after));
  await page.keyboard.press("b");
  assert.equal(await page.inputValue("#wipe"), "1");
  assert.ok((await picture()).equals(after));
});
