/** The package, the page and the element in Firefox. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { createAligner } from "sim3align";
import { work } from "../bundlers/work.js";
import { crossOriginHost, servedFolder } from "../support/element-host.js";
import { FirefoxTest, skipFirefox } from "../support/firefox.js";
import { files } from "../support/page-files.js";
import { input, mesh } from "../support/scene.js";
import { PATIENCE } from "../support/site.js";

const skip = skipFirefox;

let firefox: FirefoxTest;
before(async () => {
  // The package as installed, and the built page.
  if (!skip) firefox = await FirefoxTest.start(servedFolder);
});
after(() => firefox?.stop());

/** The installed package, below the served folder. */
const installed = "/install-test/node_modules/sim3align";

test("the package has the same bits in Firefox as in Node, in both entries, with and without workers", {
  skip,
}, async () => {
  const expected = await work(createAligner);
  const { page, errors } = await firefox.open(`${installed.slice(1)}/package.json`);
  for (const entry of ["index", "inline"]) {
    const found = (await page.evaluate(`(async () => {
      const { createAligner } = await import("${installed}/${entry}.js");
      const { work } = await import("/install-test/tests/bundlers/work.js");
      return JSON.stringify(await work(createAligner));
    })()`)) as string;
    assert.deepEqual(JSON.parse(found), expected, entry);
  }
  assert.deepEqual(errors, []);
  await page.close();
});

test("the page aligns its sample in Firefox, and poses are changed, undone and accepted", { skip }, async () => {
  const { page, errors } = await firefox.open("www/index.html#sample=mug");
  const text = (selector: string) => page.$eval(selector, (found) => found.textContent ?? "");
  await page.waitForFunction(() => /^Aligned/.test(document.querySelector("#status")?.textContent ?? ""), PATIENCE);
  await page.waitForSelector('[data-metric="iou"]:not([data-value=""])', PATIENCE);
  assert.match(await text("#confidence"), /9\d % · Likely correct/);
  const size = Array.from((await text("#dimensions")).matchAll(/[\d.]+/g), Number);
  assert.ok(size.length === 3 && size.every((side) => side > 8 && side < 14), `the mug is ${size} cm`);
  const source = () => page.$eval(".result", (panel) => panel.getAttribute("data-source"));
  await page.evaluate(() => document.querySelector<HTMLButtonElement>('[aria-label="Move left"]')?.click());
  assert.equal(await source(), "hand");
  await page.click("#undo");
  assert.equal(await source(), "aligned");
  await page.click("#accept");
  assert.match(await text("#accept"), /Accepted/);
  // The image shows the silhouette: not all of it is grey.
  const isColoured = await page.evaluate(() => {
    const canvas = document.querySelector(".image canvas") as HTMLCanvasElement;
    const { data } = (canvas.getContext("2d") as CanvasRenderingContext2D).getImageData(
      0,
      0,
      canvas.width,
      canvas.height,
    );
    return data.some((value, i) => i % 4 === 0 && Math.abs(value - (data[i + 2] ?? 0)) > 40);
  });
  assert.ok(isColoured);
  // Without WebGL, as on machines without graphics, the page says so, and results are in the image.
  await page.waitForSelector('.space:not([data-state="loading"])', PATIENCE);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a photo alone is shown in Firefox, and its object marked", { skip }, async () => {
  const { page, errors } = await firefox.open("www/index.html#sample=mug");
  await page.waitForFunction(() => /^Aligned/.test(document.querySelector("#status")?.textContent ?? ""), PATIENCE);
  await page.evaluate(async () => {
    const canvas = new OffscreenCanvas(160, 120);
    const context = canvas.getContext("2d") as OffscreenCanvasRenderingContext2D;
    for (const [colour, left, top, width, height] of [
      ["#4a5a78", 0, 0, 160, 120],
      ["#e08030", 50, 40, 60, 40],
    ] as const) {
      context.fillStyle = colour;
      context.fillRect(left, top, width, height);
    }
    const transfer = new DataTransfer();
    transfer.items.add(new File([await canvas.convertToBlob()], "photo.png"));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true }));
  });
  await page.waitForSelector("#mark-mask", PATIENCE);
  await page.click("#mark-mask");
  await page.waitForSelector("#mask-here", PATIENCE);
  await page.click("#mask-here");
  // A rectangle of 60 × 40 in 160 × 120 pixels.
  await page.waitForFunction(
    () => /^1[234] % of/.test(document.querySelector("#mask-status")?.textContent ?? ""),
    PATIENCE,
  );
  await page.click("#mask-done");
  await page.waitForSelector(".pair canvas", PATIENCE);
  assert.deepEqual(errors, []);
  await page.close();
});

test("in Firefox, a second tab takes over what the first one has open, as it was left", { skip }, async () => {
  const { page, errors } = await firefox.open("www/index.html#sample=mug");
  const aligned = (tab: typeof page) =>
    tab.waitForFunction(() => /^Aligned/.test(document.querySelector("#status")?.textContent ?? ""), PATIENCE);
  const isShown = (tab: typeof page, name: string) => tab.waitForSelector(`main[data-scene="${name}"]`, PATIENCE);
  await aligned(page);
  const dropped = Object.entries(files).map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]);
  await page.evaluate((parts) => {
    const dataTransfer = new DataTransfer();
    for (const [name = "", base64 = ""] of parts)
      dataTransfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, dropped);
  await isShown(page, "Own files");
  await aligned(page);
  await page.click("#accept");
  await page.waitForFunction(() => dispatchEvent(new Event("beforeunload", { cancelable: true })), PATIENCE);
  const other = await firefox.open("www/index.html");
  await other.page.waitForSelector("#other-tabs", PATIENCE);
  await other.page.evaluate(() => document.querySelector<HTMLElement>("#other-tabs button:last-child")?.click());
  await isShown(other.page, "Own files");
  assert.match(await other.page.$eval("#accept", ({ textContent }) => textContent ?? ""), /Accepted/);
  // It is closed in the first tab.
  await page.waitForSelector("#other-tabs", PATIENCE);
  await page.waitForSelector('main:not([data-scene="Own files"])', PATIENCE);
  assert.deepEqual([...errors, ...other.errors], []);
  await other.page.close();
  await page.close();
});

test("the element works in Firefox, also from another origin", { skip }, async () => {
  const host = await crossOriginHost();
  const { page, errors } = await firefox.open(host.path);
  const given = {
    depth: Array.from(input.depth),
    mask: Array.from(input.mask),
    ...{ width: input.width, height: input.height, camera: input.camera },
    ...{ positions: Array.from(mesh.positions), indices: Array.from(mesh.indices) },
  };
  const found = await page.evaluate(async (scene) => {
    const element = document.querySelector("sim3-align") as HTMLElement & { scene: unknown };
    const aligned = new Promise((resolve) =>
      element.addEventListener("align", (event) => resolve((event as CustomEvent).detail.objects[0].pose.matrix)),
    );
    element.scene = {
      ...{ width: scene.width, height: scene.height, camera: scene.camera },
      depth: Float32Array.from(scene.depth),
      objects: [
        {
          mask: Uint8Array.from(scene.mask),
          mesh: { positions: Float32Array.from(scene.positions), indices: Uint32Array.from(scene.indices) },
        },
      ],
    };
    return aligned;
  }, given);
  const { matrix } = await (await createAligner()).align(input);
  assert.deepEqual(found, [...matrix]);
  const area = await page.evaluate(() => {
    const panel = document.querySelector("sim3-align")?.shadowRoot?.querySelector(".result");
    return panel === null || panel === undefined ? 0 : panel.clientWidth * panel.clientHeight;
  });
  assert.ok(area > 20_000, "the sheets of the element apply");
  assert.deepEqual(errors, []);
  await page.close();
  await host.close();
});
