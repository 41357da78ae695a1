/** The examples that are pages. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import type { Page } from "playwright-core";
import { createAligner } from "sim3align";
import { readMask } from "sim3align/formats";
import { PageTest, WEBGL } from "../support/browser.js";
import { sampleDir } from "../support/environment.js";
import { examplesDir, filesOf, program } from "../support/examples.js";
import { maskIou } from "../support/results.js";
import { until } from "../support/site.js";

const { skip } = program("CHROMIUM_PATH", "Chromium", "install it (Debian and Ubuntu: apt-get install chromium)");
const started: PageTest[] = [];
after(async () => {
  for (const one of started) await one.stop();
});
const mask = await readMask(readFileSync(join(sampleDir, "mask.png")));
const vite = join(examplesDir, "node_modules", "vite", "bin", "vite.js");

/** Opens a page, and waits until it says that it is done. */
async function opened(folder: string, path: string, flags: readonly string[] = []) {
  const browser = new PageTest(folder, flags);
  started.push(browser);
  const { page, errors } = await browser.open(path);
  await page.waitForSelector('#status:is([data-state="done"], [data-state="failed"])', { timeout: 120_000 });
  assert.deepEqual(errors, []);
  assert.equal(await page.getAttribute("#status", "data-state"), "done", (await page.textContent("#status")) ?? "");
  return { page, errors };
}

test("02-browser-esm aligns the sample to the same bits as Node", { skip }, async () => {
  const { page } = await opened(examplesDir, "02-browser-esm/");
  const shown = JSON.parse((await page.textContent("#result")) ?? "");
  const direct = await (await createAligner()).align(filesOf(sampleDir));
  assert.deepEqual(shown.matrix, [...direct.matrix]);
  assert.equal(shown.confidence, direct.confidence);
  assert.equal(await page.$eval("#progress", (bar: HTMLProgressElement) => bar.value), 1);
});

/** Builds an example by Vite, and returns the folder of its page. */
function built(name: string): string {
  const cwd = join(examplesDir, name);
  execFileSync(process.execPath, [vite, "build", "--logLevel", "warn"], { cwd });
  return join(cwd, "dist");
}

/** The red and blue of an image at an address, in the size of the mask. */
async function colours(page: Page, address: string): Promise<[red: number, blue: number][]> {
  const data = await page.evaluate(
    async ([source, width, height]) => {
      const image = new Image();
      image.src = source;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [width, height];
      const context = canvas.getContext("2d") as CanvasRenderingContext2D;
      context.drawImage(image, 0, 0, width, height);
      return context.getImageData(0, 0, width, height).data;
    },
    [address, mask.width, mask.height] as const,
  );
  return Array.from(mask.data, (_, i) => [data[4 * i] ?? 0, data[4 * i + 2] ?? 0]);
}

/** The overlap of the drawn pixels with the mask. */
const overlap = (isDrawn: readonly boolean[]) => maskIou(isDrawn.map(Number), mask.data);

test("03-vite-three draws the mesh where the mask is, and the points of the depth", { skip }, async () => {
  const { page, errors } = await opened(built("03-vite-three"), "");
  assert.match((await page.textContent("#status")) ?? "", /confidence (0\.[5-9]|1\.0)/);

  // Orange pixels are the mesh's, bluish ones those of the depth.
  const drawn = async (isCloudShown: boolean) => {
    await page.setChecked("#cloud", isCloudShown);
    const address = await page.$eval("#view", (canvas: HTMLCanvasElement) => {
      // Drawing buffers last until the frame ends.
      canvas.ownerDocument.querySelector("#cloud")?.dispatchEvent(new Event("change"));
      return canvas.toDataURL();
    });
    const found = await colours(page, address);
    const isOrange = found.map(([red, blue]) => red > 1.5 * blue + 20);
    return { isOrange, cloudPixels: found.filter(([, blue], i) => !isOrange[i] && blue > 40).length };
  };
  const { isOrange, cloudPixels } = await drawn(false);
  assert.ok(overlap(isOrange) > 0.85, `IoU of the drawn mesh and the mask: ${overlap(isOrange)}`);
  assert.equal(cloudPixels, 0);
  assert.ok((await drawn(true)).cloudPixels > 0.3 * mask.data.length);
  assert.deepEqual(errors, []);
});

test("10-react draws the mesh where the photo shows it, at any size, and follows the element", { skip }, async () => {
  // Where Chromium cannot have WebGPU, a page that asks for it takes the graphics process of all canvases with it.
  const { page, errors } = await opened(built("10-react"), "", WEBGL);
  const settled = async (test: (iou: number) => boolean) => {
    await until(async () => {
      const shown = (await page.locator(".photo canvas").screenshot()).toString("base64");
      // The mesh is orange on the screen.
      return overlap((await colours(page, `data:image/png;base64,${shown}`)).map(([red, blue]) => red > blue + 60));
    }, test);
  };
  await settled((iou) => iou > 0.85);
  await page.setViewportSize({ width: 420, height: 900 });
  await page.waitForFunction(() => (document.querySelector(".photo canvas") as HTMLCanvasElement).clientWidth < 420);
  await settled((iou) => iou > 0.85);
  // A change of the pose in the element moves the mesh in the canvas.
  await page.evaluate(() => {
    const element = document.querySelector("sim3-align") as unknown as { pose: { scale: number } };
    element.pose = { ...element.pose, scale: 0.7 * element.pose.scale };
  });
  await settled((iou) => iou < 0.7);
  assert.deepEqual(errors, []);
});
