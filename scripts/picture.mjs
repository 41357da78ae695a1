/** `npm run picture`: draws the README's picture, `docs/picture.png`, from the first sample. */

import { at, repository } from "./lib/paths.mjs";
import { launchChromium } from "./lib/programs.mjs";
import { copySample } from "./lib/sample.mjs";
import { serve } from "./lib/static-server.mjs";
import { script, step } from "./lib/step.mjs";

/** The picture is a page of its own, which uses the built package. */
async function draw() {
  const [browser, server] = await Promise.all([launchChromium(), serve(repository)]);
  try {
    const page = await browser.newPage({ viewport: { width: 1000, height: 400 } });
    page.on("pageerror", (error) => console.error(error.message));
    await page.goto(`${server.url}scripts/picture/`);
    await page.waitForSelector('body[data-state="done"]');
    await page.locator("#picture").screenshot({ path: at("docs", "picture.png") });
  } finally {
    await Promise.all([browser.close(), server.close()]);
  }
}

await script(async () => {
  await copySample();
  await step("docs/picture.png", draw);
});
