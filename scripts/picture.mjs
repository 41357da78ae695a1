/** `npm run picture`: draws the README's picture and those of `docs/how-it-works.md` from the samples. */

import { cpSync, mkdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { runLab } from "./lib/lab.mjs";
import { at, repository } from "./lib/paths.mjs";
import { launchChromium } from "./lib/programs.mjs";
import { copySample, pageSamplesDir } from "./lib/sample.mjs";
import { serve } from "./lib/static-server.mjs";
import { script, step } from "./lib/step.mjs";

/** The pictures are on pages of their own, which use the built package. */
const pages = [
  { path: "scripts/picture/", viewport: { width: 1000, height: 400 }, deviceScaleFactor: 1, folder: at("docs") },
  {
    path: "scripts/picture/how-it-works.html",
    viewport: { width: 860, height: 2800 },
    deviceScaleFactor: 1.5,
    folder: at("docs", "how-it-works"),
  },
];

/** Where the page of `docs/how-it-works.md` looks for traces. */
const traces = at("target", "pictures");

/** Writes the traces of searches in the samples. */
async function trace() {
  const sample = (/** @type {string[]} */ ...path) => join(pageSamplesDir, ...path);
  const made = (/** @type {string} */ name, /** @type {string[]} */ ...sources) => {
    const folder = join(traces, name);
    for (const source of sources) cpSync(source, folder, { recursive: true });
    return folder;
  };
  rmSync(traces, { recursive: true, force: true });
  mkdirSync(traces, { recursive: true });
  const box = made("box", sample("table", "objects", "box"));
  for (const file of ["depth.png", "camera.json", "rgb.png"]) cpSync(sample("table", file), join(box, file));
  const wrong = made("wrong", sample("mug"));
  cpSync(sample("occluded", "mesh.glb"), join(wrong, "mesh.glb"));
  const runs = { mug: [sample("mug")], wide: ["--widen", "1.1", sample("mug")], wrong: [wrong], box: [box] };
  for (const [name, args] of Object.entries(runs)) {
    writeFileSync(join(traces, `${name}.json`), await runLab(["trace", ...args]));
  }
}

async function draw() {
  const [browser, server] = await Promise.all([launchChromium(), serve(repository)]);
  try {
    for (const { path, viewport, deviceScaleFactor, folder } of pages) {
      const page = await browser.newPage({ viewport, deviceScaleFactor });
      page.on("pageerror", (error) => console.error(error.message));
      await page.goto(server.url + path);
      await page.waitForSelector('body[data-state="done"]', { timeout: 120_000 });
      mkdirSync(folder, { recursive: true });
      for (const picture of await page.locator("main").all()) {
        await picture.screenshot({ path: join(folder, `${await picture.getAttribute("id")}.png`) });
      }
    }
  } finally {
    await Promise.all([browser.close(), server.close()]);
  }
}

await script(async () => {
  await copySample();
  await step("traces of searches", trace);
  await step("docs/picture.png, docs/how-it-works/", draw);
});
