/**
 * `node scripts/pictures.mjs`: the pictures of the samples, of links to the page, of the README and of the guides, as the page, the
 * element, the command line and the package draw them; with `--render`, Blender renders the first sample before. Pictures of samples have the gallery's size at twice the density, those of links the size
 * of previews.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { at, packageDir, siteDir } from "./lib/paths.mjs";
import { launchChromium } from "./lib/programs.mjs";
import { run } from "./lib/run.mjs";
import { buildSite } from "./lib/site.mjs";
import { serve } from "./lib/static-server.mjs";
import { script } from "./lib/step.mjs";
import { renderKitchen } from "./pictures/kitchen.mjs";
import { readmePicture } from "./pictures/readme.mjs";

/** @typedef {import("playwright-core").Page} Page */

/** The 3D views that guides show: the sample, and the keys pressed before the picture is taken. @type {Record<string, readonly [string, readonly string[]]>} */
const views = {
  "first-alignment": ["mug", []],
  scenes: ["table", []],
  // Together, objects stand on a support, which makes views level.
  robotics: ["table", ["Shift+A", "e"]],
  "from-a-photo": ["table", ["c"]],
};

/**
 * Writes a picture: its middle part, in this shape.
 * @param {Page} page
 * @param {Buffer} png
 * @param {string} path
 * @param {readonly [number, number]} [size] its own by default
 */
async function save(page, png, path, size) {
  const type = path.endsWith(".jpg") ? "image/jpeg" : "image/webp";
  const bytes = await page.evaluate(
    async ({ base64, type, size }) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
      const [width, height] = size ?? [image.width, image.height];
      const canvas = new OffscreenCanvas(width, height);
      const context = canvas.getContext("2d");
      if (context === null) throw new Error("The browser has no canvas.");
      const scale = Math.max(width / image.width, height / image.height);
      const [across, down] = [image.width * scale, image.height * scale];
      context.imageSmoothingQuality = "high";
      context.drawImage(image, (width - across) / 2, (height - down) / 2, across, down);
      const blob = await canvas.convertToBlob({ type, quality: 0.8 });
      return [...new Uint8Array(await blob.arrayBuffer())];
    },
    { base64: png.toString("base64"), type, size },
  );
  writeFileSync(path, Buffer.from(bytes));
}

/** The picture that the page makes to be shared. @param {Page} page */
async function shared(page) {
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Picture", exact: true }).click(),
  ]);
  return readFileSync(await download.path());
}

/** @param {Page} page */
const aligned = (page) => page.locator("#status", { hasText: /^Aligned/ }).waitFor();

/** @param {string} name */
const ofGuide = (name) => at("docs", "pictures", `${name}.webp`);

await script(async () => {
  if (process.argv.includes("--render")) await renderKitchen("python3");
  await buildSite();
  /** @type {{ id: string, picture: string }[]} */
  const samples = JSON.parse(readFileSync(at("www", "samples", "index.json"), "utf8"));
  const [site, files] = await Promise.all([serve(siteDir), serve(packageDir)]);
  const browser = await launchChromium();
  const open = () => browser.newPage({ reducedMotion: "reduce", viewport: { width: 1440, height: 900 } });
  const opened = async (/** @type {string} */ sample) => {
    const page = await open();
    await page.goto(`${site.url}?graphics=webgl#sample=${sample}`);
    await aligned(page);
    await page.locator('.space[data-state="ready"] canvas[aria-label*="placed meshes"]').waitFor();
    return page;
  };
  try {
    for (const { id, picture } of samples) {
      const page = await opened(id);
      if (id === samples[0]?.id) {
        const whole = await shared(page);
        await save(page, whole, at("www", "samples", "share.jpg"), [1200, 630]);
        await save(page, await readmePicture(browser, whole), at("docs", "picture.webp"));
      }
      // Sizes are too small to be read there.
      await page
        .locator("label.check", { hasText: /^Sizes$/ })
        .locator("input")
        .dispatchEvent("click");
      await save(page, await shared(page), at("www", "samples", picture), [320, 240]);
      await page.close();
    }
    for (const [name, [sample, keys]] of Object.entries(views)) {
      const page = await opened(sample);
      for (const key of keys) {
        await page.keyboard.press(key);
        await aligned(page);
      }
      await save(page, await shared(page), ofGuide(name), [960, 504]);
      await page.close();
    }
    const page = await opened("hammer");
    await page.getByText("Details", { exact: true }).click();
    await save(
      page,
      await page.locator("section.panel", { hasText: "longest side first" }).screenshot(),
      ofGuide("reading-confidence"),
    );

    const host = await open();
    await host.route("**/host.html", (route) =>
      route.fulfill({
        contentType: "text/html",
        body: `<!doctype html><script type="module" src="element/sim3-align.js"></script>
<sim3-align src="sample/index.json" style="block-size: 520px; inline-size: 900px"></sim3-align>`,
      }),
    );
    const folder = at("www", "samples", "table");
    await host.route("**/sample/**", (route) =>
      route.fulfill({ path: join(folder, route.request().url().split("/sample/")[1] ?? "") }),
    );
    const parts = ["teapot", "mug", "box"].flatMap((name) => [`objects/${name}/mask.png`, `objects/${name}/mesh.glb`]);
    const names = ["camera.json", "depth.png", "rgb.webp", ...parts];
    await host.route("**/sample/index.json", (route) => route.fulfill({ json: { files: names } }));
    await host.goto(`${files.url}host.html`);
    const element = host.locator("sim3-align");
    await element.locator('[data-state="ready"]').waitFor();
    await element.evaluate((one) => /** @type {HTMLElement & { align(): Promise<void> }} */ (one).align());
    await save(host, await element.screenshot({ animations: "disabled" }), ofGuide("embedding"));

    const report = at("target", "pictures");
    const cases = ["mug", "hammer", "spoon", "occluded"].map((name) => at("www", "samples", name));
    await run(process.execPath, [join(packageDir, "cli", "main.js"), "align", ...cases, "--report", report]);
    await host.setViewportSize({ width: 1440, height: 620 });
    await host.goto(pathToFileURL(join(report, "index.html")).href);
    await host.waitForLoadState("networkidle");
    await save(host, await host.screenshot(), ofGuide("batches"));
  } finally {
    await browser.close();
    await Promise.all([site.close(), files.close()]);
  }
});
