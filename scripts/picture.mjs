/** `npm run picture`: the README's picture, `docs/picture.png`, drawn by Chromium from the generated sample. */
import { statSync } from "node:fs";
import { chromium as browserType } from "playwright-core";
import { chromium, chromiumRemedy } from "./lib/chromium.mjs";
import { buildPackage } from "./lib/package.mjs";
import { at, repository } from "./lib/paths.mjs";
import { makeSample } from "./lib/sample.mjs";
import { setUp } from "./lib/setup.mjs";
import { serve } from "./lib/static-server.mjs";
import { script, step } from "./lib/step.mjs";

const file = at("docs", "picture.png");

async function draw() {
  const executablePath = await chromium();
  if (executablePath === undefined) throw new Error(`No Chromium. Remedy: ${chromiumRemedy}.`);
  const server = await serve(repository);
  const browser = await browserType.launch({ executablePath, args: ["--no-sandbox"] });
  try {
    const page = await browser.newPage({ viewport: { width: 1000, height: 400 } });
    page.on("pageerror", (error) => console.error(error.message));
    await page.goto(`${server.url}scripts/picture/`);
    await page.waitForSelector('body[data-state="done"]');
    await page.locator("#picture").screenshot({ path: file });
  } finally {
    await browser.close();
    await server.close();
  }
}

await script(async () => {
  await setUp();
  await buildPackage();
  await makeSample();
  await step("picture", async (say) => {
    await draw();
    say(`docs/picture.png, ${Math.round(statSync(file).size / 1000)} kB`);
  });
});
