/**
 * `node scripts/pictures.mjs`: the pictures of the samples and the one of links to the page, as the page draws them. Their sizes are
 * those of the gallery at twice the density, and of previews of links.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { at, siteDir } from "./lib/paths.mjs";
import { launchChromium } from "./lib/programs.mjs";
import { buildSite } from "./lib/site.mjs";
import { serve } from "./lib/static-server.mjs";
import { script } from "./lib/step.mjs";

/** @param {import("playwright-core").Page} page @param {string} url @param {string} type @param {readonly [number, number]} size */
const converted = (page, url, type, [width, height]) =>
  page.evaluate(
    async ({ url, type, width, height }) => {
      const image = await createImageBitmap(await (await fetch(url)).blob());
      const canvas = new OffscreenCanvas(width, height);
      const context = canvas.getContext("2d");
      if (context === null) throw new Error("The browser has no canvas.");
      // The middle part, in the shape that is wanted.
      const scale = Math.max(width / image.width, height / image.height);
      const [across, down] = [image.width * scale, image.height * scale];
      context.imageSmoothingQuality = "high";
      context.drawImage(image, (width - across) / 2, (height - down) / 2, across, down);
      const blob = await canvas.convertToBlob({ type, quality: 0.8 });
      return [...new Uint8Array(await blob.arrayBuffer())];
    },
    { url, type, width, height },
  );

await script(async () => {
  await buildSite();
  /** @type {{ id: string, picture: string }[]} */
  const samples = JSON.parse(readFileSync(at("www", "samples", "index.json"), "utf8"));
  const server = await serve(siteDir);
  const browser = await launchChromium();
  try {
    for (const { id, picture } of samples) {
      const page = await browser.newPage({ reducedMotion: "reduce", viewport: { width: 1440, height: 900 } });
      await page.goto(`${server.url}?graphics=webgl#sample=${id}`);
      await page.locator("#status", { hasText: /^Aligned/ }).waitFor();
      await page.locator('.space[data-state="ready"] canvas[aria-label*="placed meshes"]').waitFor();
      const taken = async () => {
        const [download] = await Promise.all([
          page.waitForEvent("download"),
          page.evaluate(() => {
            const button = [...document.querySelectorAll("button")].find(
              (one) => one.textContent === "Picture to share",
            );
            button?.click();
          }),
        ]);
        const parts = [];
        for await (const part of await download.createReadStream()) parts.push(part);
        return `data:image/png;base64,${Buffer.concat(parts).toString("base64")}`;
      };
      if (id === samples[0]?.id) {
        writeFileSync(
          at("www", "samples", "share.jpg"),
          Buffer.from(await converted(page, await taken(), "image/jpeg", [1200, 630])),
        );
      }
      // Sizes are too small to be read there.
      await page.evaluate(() => {
        const boxes = [...document.querySelectorAll("label.check")];
        boxes
          .find((one) => one.textContent === "Sizes")
          ?.querySelector("input")
          ?.click();
      });
      writeFileSync(
        at("www", "samples", picture),
        Buffer.from(await converted(page, await taken(), "image/webp", [320, 240])),
      );
      await page.close();
    }
  } finally {
    await browser.close();
    await server.close();
  }
});
