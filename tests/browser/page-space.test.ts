/** The 3D view: with WebGPU, with WebGL 2, with neither. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { SOFTWARE_WEBGPU } from "../support/browser.js";
import { PATIENCE, type Pixels, type SitePage, SiteTest } from "../support/site.js";

const backends: readonly ["webgpu" | "webgl", string[]][] = [
  ["webgpu", SOFTWARE_WEBGPU],
  ["webgl", ["!--enable-unsafe-webgpu"]],
];

/**
 * What is seen of the 3D view, as soon as it is what is waited for.
 *
 * How long a picture takes where a processor draws it, nobody knows: so what it shows is asked, not whether it keeps
 * still, which an old picture does too.
 * @param what for the message: what it should be, and how far it is from that
 */
async function seen(page: Page, what: (picture: Pixels) => string, isIt: (picture: Pixels) => boolean) {
  const end = Date.now() + PATIENCE.timeout;
  for (;;) {
    const picture = await glimpse(page);
    if (isIt(picture)) return picture;
    if (Date.now() > end) {
      const state = await page.locator(".space").evaluate((space) => space.querySelector(".view-host")?.outerHTML);
      assert.fail(`${what(picture)} in ${state}`);
    }
    await page.waitForTimeout(300);
  }
}

/** The 3D view once it keeps still. */
async function still(page: Page): Promise<Pixels> {
  let last: Pixels | undefined;
  return seen(
    page,
    () => "the 3D view goes on moving",
    (now) => {
      const isStill = last?.data.equals(now.data) === true;
      last = now;
      return isStill;
    },
  );
}

/** What is seen of the 3D view at the moment. */
async function glimpse(page: Page): Promise<Pixels> {
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

/** The pixels that differ plainly from what they are compared with: another picture's, or a colour. */
function differing({ data }: Pixels, other: (pixel: number, channel: number) => number): number[] {
  return Array.from({ length: data.length / 4 }, (_, pixel) => pixel).filter((pixel) =>
    [0, 1, 2].some((k) => Math.abs((data[4 * pixel + k] ?? 0) - other(pixel, k)) > 24),
  );
}

/** The pixels that differ plainly between two pictures. */
function changed(a: Pixels, b: Pixels): number[] {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  return differing(a, (pixel, k) => b.data[4 * pixel + k] ?? 0);
}

/** The pixels that are not as a corner is, where nothing is. */
const drawn = (picture: Pixels) => differing(picture, (_, k) => picture.data[k] ?? 0);

/** The ratio of the pixels where something is. */
const ratio = (picture: Pixels) => drawn(picture).length / (picture.width * picture.height);

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
      const told = (picture: Pixels) => `something is at ${ratio(picture)} of the pixels`;
      await seen(page, told, (picture) => ratio(picture) > 0.01);
      await page.getByRole("button", { name: "Camera", exact: true }).click();
      await show(page, "Points", false);
      await show(page, "Mesh", false);
      await seen(page, told, (picture) => ratio(picture) < 0.001);
      await show(page, "Mesh", true);
      const mesh = await seen(page, told, (picture) => ratio(picture) > 0.003 && ratio(picture) < 0.4);
      await show(page, "Mesh", false);
      await show(page, "Points", true);
      await seen(page, told, (picture) => ratio(picture) > 0.4);
      // From the camera's place the mesh covers its mask: the middle of the one is within the other.
      const columns = drawn(mesh)
        .map((pixel) => pixel % mesh.width)
        .sort((a, b) => a - b);
      const middle = (columns[Math.floor(columns.length / 2)] ?? 0) / mesh.width;
      assert.ok(middle > 0.4 && middle < 0.6, `the mesh is at ${middle} of the width`);

      await show(page, "Points", false);
      await show(page, "Mesh", true);
      // As it was, before there are handles too.
      await seen(
        page,
        (picture) => `another mesh: ${changed(picture, mesh).length} pixels`,
        (picture) => changed(picture, mesh).length === 0,
      );
      await page.getByRole("button", { name: "Move", exact: true }).click();
      const redOf = (picture: Pixels) =>
        changed(picture, mesh).filter((pixel) => {
          const [r = 0, g = 0, b = 0] = picture.data.subarray(4 * pixel, 4 * pixel + 3);
          return r > 150 && g < 90 && b < 90;
        });
      const handles = await seen(
        page,
        (picture) => `the red handle has ${redOf(picture).length} pixels`,
        (picture) => redOf(picture).length > 20,
      );
      const red = redOf(handles);
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
    const before = await still(page);
    await page.hover(".space canvas");
    await page.locator(".image .cross").waitFor();
    assert.match((await page.textContent(".readout")) ?? "", /^\d+, \d+: /);
    // The image's middle is the 3D view's, from the camera's place.
    await page.hover(".image canvas");
    const marked = await seen(
      page,
      (picture) => `the mark has ${changed(picture, before).length} pixels`,
      (picture) => changed(picture, before).length > 30,
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
      (picture) => `the mark stays: ${changed(picture, before).length} pixels`,
      (picture) => changed(picture, before).length === 0,
    );
    // A click in the image chooses the object, and turns the other view about it.
    await page.locator(".objects button").nth(2).click();
    await page.locator(".image canvas").click();
    await page.getByRole("button", { name: "Top", exact: true }).click();
    await seen(
      page,
      (picture) => `${changed(picture, before).length} pixels are others from above`,
      (picture) => changed(picture, before).length > 1000,
    );
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
