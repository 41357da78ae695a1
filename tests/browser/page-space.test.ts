/** The 3D view: with WebGPU, with WebGL 2, with neither. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { PATIENCE, type SitePage, SiteTest } from "../support/site.js";

/** WebGPU on the processor, as Chromium offers it without a graphics card. */
const softwareWebGpu = [
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--ignore-gpu-blocklist",
  "--enable-gpu",
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
];

const backends: readonly ["webgpu" | "webgl", string[]][] = [
  ["webgpu", softwareWebGpu],
  ["webgl", ["!--enable-unsafe-webgpu"]],
];

/** A picture's pixels: red, green, blue, opacity. */
interface Picture {
  width: number;
  height: number;
  data: Buffer;
}

/** A frame without a graphics card may take this long, in milliseconds, and an animation longer. */
const FRAME_MS = 1500;

/**
 * What is seen of the 3D view once it keeps still, and no longer shows what was seen before; or what it has come to in
 * twenty frames.
 */
async function seen(page: Page, before?: Picture): Promise<Picture> {
  let last = await glimpse(page);
  for (let frame = 0; frame < 20; frame++) {
    await page.waitForTimeout(FRAME_MS);
    const now = await glimpse(page);
    const isStill = now.data.equals(last.data);
    if (isStill && before?.data.equals(now.data) !== true) return now;
    last = now;
  }
  return last;
}

/** What is seen of the 3D view at the moment. */
async function glimpse(page: Page): Promise<Picture> {
  const png = await page.locator(".space .view-host").screenshot();
  const decoded = (await page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const { width, height } = bitmap;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context?.drawImage(bitmap, 0, 0);
    const { data } = context?.getImageData(0, 0, width, height) ?? { data: new Uint8ClampedArray() };
    const rows = Array.from({ length: height }, (_, v) => data.subarray(4 * v * width, 4 * (v + 1) * width));
    return { width, height, text: btoa(rows.map((row) => String.fromCharCode(...row)).join("")) };
  }, png.toString("base64"))) as { width: number; height: number; text: string };
  return { ...decoded, data: Buffer.from(decoded.text, "base64") };
}

/** The pixels that differ plainly between two pictures. */
function changed(a: Picture, b: Picture): number[] {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  return Array.from({ length: a.width * a.height }, (_, pixel) => pixel).filter((pixel) =>
    [0, 1, 2].some((k) => Math.abs((a.data[4 * pixel + k] ?? 0) - (b.data[4 * pixel + k] ?? 0)) > 24),
  );
}

const ready = ({ page }: SitePage, backend: string) =>
  page.locator(`.view-host[data-backend="${backend}"] canvas`).waitFor(PATIENCE);

const show = (page: Page, name: string, isShown: boolean) =>
  page.locator(".space").getByLabel(name, { exact: true }).setChecked(isShown);

for (const [backend, flags] of backends) {
  test(`${backend} draws the points and the mesh, and handles move it`, async () => {
    const site = await SiteTest.start(flags);
    try {
      const opened = await site.open();
      const { page } = opened;
      await ready(opened, backend);
      await page.getByRole("button", { name: "Camera", exact: true }).click();
      await show(page, "Points", false);
      await show(page, "Mesh", false);
      const nothing = await seen(page);
      await show(page, "Mesh", true);
      const mesh = await seen(page, nothing);
      await show(page, "Points", true);
      await show(page, "Mesh", false);
      const points = await seen(page, mesh);
      const total = nothing.width * nothing.height;
      const [ofMesh, ofPoints] = [changed(mesh, nothing), changed(points, nothing)];
      assert.ok(ofMesh.length > 0.003 * total && ofMesh.length < 0.4 * total, `mesh: ${ofMesh.length} of ${total}`);
      assert.ok(ofPoints.length > 0.3 * total, `points: ${ofPoints.length} of ${total}`);
      // From the camera's place the mesh covers its mask: the middle of the one is within the other.
      const columns = ofMesh.map((pixel) => pixel % mesh.width).sort((a, b) => a - b);
      const middle = (columns[Math.floor(columns.length / 2)] ?? 0) / mesh.width;
      assert.ok(middle > 0.4 && middle < 0.6, `the mesh is at ${middle} of the width`);

      await show(page, "Points", false);
      await show(page, "Mesh", true);
      // As it was, before there are handles too.
      await seen(page, points);
      await page.getByRole("button", { name: "Move", exact: true }).click();
      const handles = await seen(page, mesh);
      const red = changed(handles, mesh).filter((pixel) => {
        const [r = 0, g = 0, b = 0] = handles.data.subarray(4 * pixel, 4 * pixel + 3);
        return r > 150 && g < 90 && b < 90;
      });
      assert.ok(red.length > 20, `the red handle has ${red.length} pixels`);
      // Its far end.
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
      assert.ok((await opened.metric("iou")) < iou, "it was not moved away");
      await page.click("#refine");
      await opened.isNow("refined");
      assert.ok((await opened.metric("iou")) > iou - 0.02, "it was not brought back");
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
    const opened = await site.open("#sample=desk");
    const { page } = opened;
    await ready(opened, "webgl");
    await page.getByRole("button", { name: "Camera", exact: true }).click();
    const before = await seen(page);
    await page.hover(".space canvas");
    await page.locator(".image .cross").waitFor();
    assert.match((await page.textContent(".readout")) ?? "", /^\d+, \d+: /);
    // A click in the image chooses the object, and turns the other view about it.
    await page.locator(".objects button").nth(2).click();
    await page.locator(".image canvas").click();
    await page.getByRole("button", { name: "Top", exact: true }).click();
    assert.ok(changed(await seen(page, before), before).length > 1000);
    await opened.close();
  } finally {
    await site.stop();
  }
});

test("without any graphics the page says so, and does all the rest", async () => {
  const site = await SiteTest.start(["!--enable-unsafe-webgpu", "--disable-3d-apis"]);
  try {
    const opened = await site.open();
    const { page } = opened;
    await page.getByText(/neither WebGPU nor WebGL 2/).waitFor(PATIENCE);
    assert.ok(await page.isDisabled(".looks button"));
    const { data } = await opened.imagePixels();
    assert.ok(new Set(data).size > 50, "the image is empty");
    await page.click(".hand-panel .more summary");
    await page.getByRole("button", { name: "Move left", exact: true }).click();
    await opened.isNow("hand");
    await page.click("#refine");
    await opened.isNow("refined");
    assert.ok((await opened.saved("PNG of view")).bytes.length > 5000);
    await opened.close();
  } finally {
    await site.stop();
  }
});
