/** The examples that are pages. */
import assert from "node:assert/strict";
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, test } from "node:test";
import { createAligner } from "sim3align";
import { readMask } from "sim3align/formats";
import { PageTest, WEBGL } from "../support/browser.js";
import { sampleDir } from "../support/environment.js";
import { examplesDir, filesOf, program } from "../support/examples.js";

const { skip } = program("CHROMIUM_PATH", "Chromium", "install it (Debian and Ubuntu: apt-get install chromium)");
const started: { stop(): unknown }[] = [];
after(async () => {
  for (const one of started) await one.stop();
});

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

const vite = join(examplesDir, "node_modules", "vite", "bin", "vite.js");
const viteFolder = join(examplesDir, "03-vite-three");

/** Vite's own server, as `npm start` starts it. */
async function devServer(): Promise<string> {
  const child: ChildProcess = spawn(process.execPath, [vite, "--host", "127.0.0.1", "--port", "0"], {
    cwd: viteFolder,
  });
  started.push({
    stop: () => {
      child.kill();
      return once(child, "exit");
    },
  });
  assert.ok(child.stdout);
  for await (const line of createInterface({ input: child.stdout })) {
    // biome-ignore lint/suspicious/noControlCharactersInRegex: colours are control characters.
    const address = /http:\/\/127\.0\.0\.1:\d+\//.exec(line.replace(/\u001b\[[0-9;]*m/g, ""));
    if (address) return address[0];
  }
  throw new Error("Vite did not start.");
}

for (const kind of ["built", "served by Vite"]) {
  test(`03-vite-three, ${kind}, draws the mesh where the mask is`, { skip }, async () => {
    let path = "";
    if (kind === "built") execFileSync(process.execPath, [vite, "build", "--logLevel", "warn"], { cwd: viteFolder });
    else path = await devServer();
    const { page, errors } = await opened(join(viteFolder, "dist"), path);
    assert.match((await page.textContent("#status")) ?? "", /confidence (0\.[5-9]|1\.0)/);

    // Orange pixels, which are the mesh's: with the depth's points before it some, without them all.
    const drawn = async (isCloudShown: boolean) => {
      await page.setChecked("#cloud", isCloudShown);
      const url = await page.$eval("#view", (canvas: HTMLCanvasElement) => {
        // Drawing buffers last until the frame ends.
        canvas.ownerDocument.querySelector("#cloud")?.dispatchEvent(new Event("change"));
        return canvas.toDataURL();
      });
      return page.evaluate(async (source: string) => {
        const image = new Image();
        image.src = source;
        await image.decode();
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [image.width, image.height];
        const context = canvas.getContext("2d") as CanvasRenderingContext2D;
        context.drawImage(image, 0, 0);
        const { data } = context.getImageData(0, 0, image.width, image.height);
        const isOrange = Array.from(
          { length: data.length / 4 },
          (_, i) => (data[4 * i] ?? 0) > 1.5 * (data[4 * i + 2] ?? 0) + 20,
        );
        const cloudPixels = isOrange.filter((orange, i) => !orange && (data[4 * i + 2] ?? 0) > 40).length;
        return { width: image.width, height: image.height, isOrange, cloudPixels };
      }, url);
    };
    const mask = await readMask(readFileSync(join(sampleDir, "mask.png")));
    const mesh = await drawn(false);
    assert.deepEqual([mesh.width, mesh.height], [mask.width, mask.height]);
    let [intersection, union] = [0, 0];
    mesh.isOrange.forEach((orange, i) => {
      const isObject = mask.data[i] !== 0;
      intersection += orange && isObject ? 1 : 0;
      union += orange || isObject ? 1 : 0;
    });
    assert.ok(intersection / union > 0.85, `IoU of the drawn mesh and the mask: ${intersection / union}`);
    assert.equal(mesh.cloudPixels, 0);
    const { cloudPixels } = await drawn(true);
    assert.ok(cloudPixels > 0.3 * mask.data.length, `${cloudPixels} pixels of the depth's points`);
    assert.deepEqual(errors, []);
  });
}

const reactFolder = join(examplesDir, "10-react");

test("10-react draws the mesh where the photo shows it, at any size, and follows the element", { skip }, async () => {
  execFileSync(process.execPath, [vite, "build", "--logLevel", "warn"], { cwd: reactFolder });
  // Where Chromium cannot have WebGPU, a page that asks for it takes the graphics process of all canvases with it.
  const { page, errors } = await opened(join(reactFolder, "dist"), "", WEBGL);
  const mask = await readMask(readFileSync(join(sampleDir, "mask.png")));
  /** The overlap of the mesh, which is orange on the screen, with the mask. */
  const overlap = async () => {
    const shown = await page.locator(".photo canvas").screenshot();
    const isOrange = await page.evaluate(
      async ([png, width, height]) => {
        const image = new Image();
        image.src = `data:image/png;base64,${png}`;
        await image.decode();
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [width, height];
        const context = canvas.getContext("2d") as CanvasRenderingContext2D;
        context.drawImage(image, 0, 0, width, height);
        const { data } = context.getImageData(0, 0, width, height);
        return Array.from({ length: width * height }, (_, i) =>
          (data[4 * i] ?? 0) > (data[4 * i + 2] ?? 0) + 60 ? 1 : 0,
        );
      },
      [shown.toString("base64"), mask.width, mask.height] as const,
    );
    const count = (test: (i: number) => boolean) => isOrange.filter((_, i) => test(i)).length;
    const both = count((i) => isOrange[i] === 1 && mask.data[i] !== 0);
    return both / count((i) => isOrange[i] === 1 || mask.data[i] !== 0);
  };
  const settled = async (test: (iou: number) => boolean) => {
    let iou = await overlap();
    for (let i = 0; i < 20 && !test(iou); i++) iou = await overlap();
    assert.ok(test(iou), `IoU of the drawn mesh and the mask: ${iou}`);
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
