/** The 3D view in the page: with WebGPU, with WebGL 2, with neither. */
import assert from "node:assert/strict";
import type { Page } from "playwright-core";
import { SOFTWARE_WEBGPU, WEBGL, WITHOUT_3D } from "../support/browser.js";
import { PATIENCE, type Pixels, pageTests, spacePixels, until } from "../support/site.js";

/** Takes screenshots of the 3D view until what is measured in them is as wanted, and returns the last one. */
async function seen<T>(page: Page, measure: (image: Pixels) => T, isWanted: (found: T) => boolean): Promise<Pixels> {
  let image: Pixels | undefined;
  const measured = async () => {
    image = await spacePixels(page);
    return measure(image);
  };
  await until(measured, isWanted);
  return image as Pixels;
}

/** The 3D view after two equal screenshots. */
async function still(page: Page): Promise<Pixels> {
  let last: Pixels | undefined;
  const isSame = (image: Pixels) => {
    const same = last?.data.equals(image.data) === true;
    last = image;
    return same;
  };
  return seen(page, isSame, (is) => is);
}

/** The pixels that differ clearly from a reference. */
function differing({ data }: Pixels, other: (pixel: number, channel: number) => number): number[] {
  return Array.from({ length: data.length / 4 }, (_, pixel) => pixel).filter((pixel) =>
    [0, 1, 2].some((k) => Math.abs((data[4 * pixel + k] ?? 0) - other(pixel, k)) > 24),
  );
}

/** The pixels that differ clearly between two images. */
function changed(a: Pixels, b: Pixels): number[] {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  return differing(a, (pixel, k) => b.data[4 * pixel + k] ?? 0);
}

/** The pixels that differ from the top left corner, which is background. */
const drawn = (image: Pixels) => differing(image, (_, k) => image.data[k] ?? 0);

/** The share of pixels that are not background. */
const ratio = (image: Pixels) => drawn(image).length / (image.width * image.height);

for (const [backend, flags] of [
  ["webgpu", SOFTWARE_WEBGPU],
  ["webgl", WEBGL],
] as const) {
  const test = pageTests(flags);
  test(`${backend} draws the points and the mesh, and handles move the mesh`, async (opened, page) => {
    await opened.has3d(backend);
    await seen(page, ratio, (share) => share > 0.01);
    await opened.press("Camera");
    for (const layer of ["Sizes", "Points", "Mesh"]) await opened.show3d(layer, false);
    await seen(page, ratio, (share) => share < 0.001);
    await opened.show3d("Mesh", true);
    const mesh = await seen(page, ratio, (share) => share > 0.003 && share < 0.4);
    await opened.show3d("Mesh", false);
    await opened.show3d("Points", true);
    await seen(page, ratio, (share) => share > 0.4);
    // In the camera view, the mesh covers its mask, which is at the centre.
    const columns = drawn(mesh)
      .map((pixel) => pixel % mesh.width)
      .sort((a, b) => a - b);
    const middle = (columns[Math.floor(columns.length / 2)] ?? 0) / mesh.width;
    assert.ok(middle > 0.4 && middle < 0.6, `the mesh is at ${middle} of the width`);

    await opened.show3d("Points", false);
    await opened.show3d("Mesh", true);
    // Wait for the same image as before, without handles.
    await seen(
      page,
      (image) => changed(image, mesh).length,
      (count) => count === 0,
    );
    await opened.press("Move");
    const redOf = (image: Pixels) =>
      changed(image, mesh).filter((pixel) => {
        const [r = 0, g = 0, b = 0] = image.data.subarray(4 * pixel, 4 * pixel + 3);
        return r > 150 && g < 90 && b < 90;
      });
    const red = redOf(
      await seen(
        page,
        (image) => redOf(image).length,
        (count) => count > 20,
      ),
    );
    // The tip of the handle.
    const end = red.reduce((far, pixel) => (pixel % mesh.width > far % mesh.width ? pixel : far), red[0] ?? 0);
    const host = await page.locator(".space .view-host").boundingBox();
    const [x, y] = [(host?.x ?? 0) + (end % mesh.width) - 4, (host?.y ?? 0) + Math.floor(end / mesh.width)];
    const iou = await opened.metric("iou");
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 6, y, { steps: 3 });
    await page.mouse.move(x + 12, y, { steps: 3 });
    await page.mouse.up();
    await opened.isNow("hand");
    assert.ok((await opened.metric("iou")) < iou, "the mesh was not moved");
    await page.click("#refine");
    await opened.isNow("refined");
    assert.ok((await opened.metric("iou")) > iou - 0.02, "the pose was not restored");
    await page.keyboard.press("Control+z");
    await opened.isNow("hand");
    await page.keyboard.press("Control+z");
    await opened.isNow("aligned");
    assert.equal(await opened.metric("iou"), iou);
  });
}

// Without animations, the objects are at their poses as soon as the label names them.
const desk = { address: "#sample=desk", reducedMotion: "reduce" } as const;
pageTests(WEBGL)("the two views are linked", desk, async (opened, page) => {
  await opened.has3d("webgl");
  await page.locator('.space canvas[aria-label*="placed meshes: Box, Teapot, Animal"]').waitFor(PATIENCE);
  await opened.press("Camera");
  const before = await still(page);
  await page.hover(".space canvas");
  await page.locator(".image .cross").waitFor();
  assert.match((await page.textContent(".readout")) ?? "", /^\d+, \d+: /);
  // In the camera view, the centre of the image is the centre of the 3D view.
  await page.hover(".image canvas");
  const change = (image: Pixels) => changed(image, before).length;
  const marked = await seen(page, change, (count) => count > 30);
  const ring = changed(marked, before);
  for (const [size, at] of [
    [marked.width, (pixel: number) => pixel % marked.width],
    [marked.height, (pixel: number) => Math.floor(pixel / marked.width)],
  ] as const) {
    const [low, high] = [Math.min(...ring.map(at)), Math.max(...ring.map(at))];
    assert.ok(Math.abs((low + high) / 2 - size / 2) < 4 && high - low < 40, `a mark from ${low} to ${high} of ${size}`);
  }
  await page.hover("h1");
  await seen(page, change, (count) => count === 0);
  // A click in the image selects the object and centres the 3D view on it.
  await page.locator(".objects .select").nth(2).click();
  await page.locator(".image canvas").click();
  await opened.press("Top");
  await seen(page, change, (count) => count > 1000);
});

pageTests(WITHOUT_3D)("without graphics the page says so, and everything else works", async (opened, page) => {
  await page.getByText(/neither WebGPU nor WebGL 2/).waitFor(PATIENCE);
  assert.ok(await page.locator(".space").getByRole("button", { name: "Top", includeHidden: true }).isDisabled());
  const { data } = await opened.imagePixels();
  assert.ok(new Set(data).size > 50, "the image is empty");
  await page.click(".hand-panel .more summary");
  await opened.press("Move left");
  await opened.isNow("hand");
  await page.click("#refine");
  await opened.isNow("refined");
  assert.ok((await opened.saved("PNG of the view")).bytes.length > 5000);
});
