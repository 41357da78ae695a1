/** The 3D view in the page: with WebGPU, with WebGL 2, with neither. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { SOFTWARE_WEBGPU } from "../support/browser.js";
import { PATIENCE, type Pixels, type SitePage, SiteTest, spacePixels } from "../support/site.js";

const backends: readonly ["webgpu" | "webgl", string[]][] = [
  ["webgpu", SOFTWARE_WEBGPU],
  ["webgl", ["!--enable-unsafe-webgpu"]],
];

/**
 * Takes screenshots of the 3D view until one meets a condition.
 *
 * The drawing time of software renderers is unknown, so tests wait for the expected content.
 * @param describe the state of an image, for the message of a failure
 */
async function seen(page: Page, describe: (image: Pixels) => string, condition: (image: Pixels) => boolean) {
  const end = Date.now() + PATIENCE.timeout;
  for (;;) {
    const image = await spacePixels(page);
    if (condition(image)) return image;
    if (Date.now() > end) {
      const state = await page.locator(".space").evaluate((space) => space.querySelector(".view-host")?.outerHTML);
      assert.fail(`${describe(image)} in ${state}`);
    }
  }
}

/** The 3D view after two equal screenshots. */
async function still(page: Page): Promise<Pixels> {
  let last: Pixels | undefined;
  return seen(
    page,
    () => "the 3D view keeps changing",
    (image) => {
      const isStill = last?.data.equals(image.data) === true;
      last = image;
      return isStill;
    },
  );
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

const ready = ({ page }: SitePage, backend: string) =>
  page.locator(`.view-host[data-backend="${backend}"] canvas`).waitFor(PATIENCE);

const show = (page: Page, name: string, isShown: boolean) =>
  page.locator(".space").getByLabel(name, { exact: true }).setChecked(isShown);

for (const [backend, flags] of backends) {
  test(`${backend} draws the points and the mesh, and handles move the mesh`, async () => {
    const site = await SiteTest.start(flags);
    try {
      const opened = await site.open();
      const { page } = opened;
      await ready(opened, backend);
      const describe = (image: Pixels) => `${ratio(image)} of the pixels are drawn`;
      await seen(page, describe, (image) => ratio(image) > 0.01);
      await page.getByRole("button", { name: "Camera", exact: true }).click();
      await show(page, "Sizes", false);
      await show(page, "Points", false);
      await show(page, "Mesh", false);
      await seen(page, describe, (image) => ratio(image) < 0.001);
      await show(page, "Mesh", true);
      const mesh = await seen(page, describe, (image) => ratio(image) > 0.003 && ratio(image) < 0.4);
      await show(page, "Mesh", false);
      await show(page, "Points", true);
      await seen(page, describe, (image) => ratio(image) > 0.4);
      // In the camera view, the mesh covers its mask, which is at the centre.
      const columns = drawn(mesh)
        .map((pixel) => pixel % mesh.width)
        .sort((a, b) => a - b);
      const middle = (columns[Math.floor(columns.length / 2)] ?? 0) / mesh.width;
      assert.ok(middle > 0.4 && middle < 0.6, `the mesh is at ${middle} of the width`);

      await show(page, "Points", false);
      await show(page, "Mesh", true);
      // Wait for the same image as before, without handles.
      await seen(
        page,
        (image) => `${changed(image, mesh).length} pixels have changed`,
        (image) => changed(image, mesh).length === 0,
      );
      await page.getByRole("button", { name: "Move", exact: true }).click();
      const redOf = (image: Pixels) =>
        changed(image, mesh).filter((pixel) => {
          const [r = 0, g = 0, b = 0] = image.data.subarray(4 * pixel, 4 * pixel + 3);
          return r > 150 && g < 90 && b < 90;
        });
      const handles = await seen(
        page,
        (image) => `the red handle has ${redOf(image).length} pixels`,
        (image) => redOf(image).length > 20,
      );
      const red = redOf(handles);
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
      await opened.close();
    } finally {
      await site.stop();
    }
  });
}

test("the two views are linked", async () => {
  const site = await SiteTest.start(["!--enable-unsafe-webgpu"]);
  try {
    // Without animations, the objects are at their poses as soon as the label names them.
    const opened = await site.open("#sample=desk", { reducedMotion: "reduce" });
    const { page } = opened;
    await ready(opened, "webgl");
    await page.locator('.space canvas[aria-label*="placed meshes: Box, Teapot, Animal"]').waitFor(PATIENCE);
    await page.getByRole("button", { name: "Camera", exact: true }).click();
    const before = await still(page);
    await page.hover(".space canvas");
    await page.locator(".image .cross").waitFor();
    assert.match((await page.textContent(".readout")) ?? "", /^\d+, \d+: /);
    // In the camera view, the centre of the image is the centre of the 3D view.
    await page.hover(".image canvas");
    const marked = await seen(
      page,
      (image) => `the mark has ${changed(image, before).length} pixels`,
      (image) => changed(image, before).length > 30,
    );
    const ring = changed(marked, before);
    for (const [size, at] of [
      [marked.width, (pixel: number) => pixel % marked.width],
      [marked.height, (pixel: number) => Math.floor(pixel / marked.width)],
    ] as const) {
      const [low, high] = [Math.min(...ring.map(at)), Math.max(...ring.map(at))];
      assert.ok(
        Math.abs((low + high) / 2 - size / 2) < 4 && high - low < 40,
        `a mark from ${low} to ${high} of ${size}`,
      );
    }
    await page.hover("h1");
    await seen(
      page,
      (image) => `the mark is still there: ${changed(image, before).length} pixels`,
      (image) => changed(image, before).length === 0,
    );
    // A click in the image selects the object and centres the 3D view on it.
    await page.locator(".objects .select").nth(2).click();
    await page.locator(".image canvas").click();
    await page.getByRole("button", { name: "Top", exact: true }).click();
    await seen(
      page,
      (image) => `${changed(image, before).length} pixels have changed`,
      (image) => changed(image, before).length > 1000,
    );
    await opened.close();
  } finally {
    await site.stop();
  }
});

test("without graphics the page says so, and everything else works", async () => {
  const site = await SiteTest.start(["!--enable-unsafe-webgpu", "--disable-3d-apis"]);
  try {
    const opened = await site.open();
    const { page } = opened;
    await page.getByText(/neither WebGPU nor WebGL 2/).waitFor(PATIENCE);
    assert.ok(await page.isDisabled(".viewpoints button"));
    const { data } = await opened.imagePixels();
    assert.ok(new Set(data).size > 50, "the image is empty");
    await page.click(".hand-panel .more summary");
    await page.getByRole("button", { name: "Move left", exact: true }).click();
    await opened.isNow("hand");
    await page.click("#refine");
    await opened.isNow("refined");
    assert.ok((await opened.saved("PNG of the view")).bytes.length > 5000);
    await opened.close();
  } finally {
    await site.stop();
  }
});
