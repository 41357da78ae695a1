/** The page of `align --report`, opened from disk: table, details, 3D, accessibility, and a thousand rows. */
import assert from "node:assert/strict";
import { join } from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import type { Page } from "playwright-core";
import { violations } from "../support/axe.js";
import { browserFor, SOFTWARE } from "../support/browser.js";
import { files, folder, results, run, writeCase } from "../support/command-line.js";

const address = pathToFileURL(join(folder, "report", "index.html")).href;

const browser = browserFor(folder, SOFTWARE);
before(() => {
  for (const name of ["alpha", "beta"]) writeCase(name, files);
  const { "mask.png": _, ...incomplete } = files;
  writeCase("<b>gamma", incomplete);
  const names = ["alpha", "beta", "<b>gamma"];
  const { status } = run("align", ...names, ..."--quality fast --report report --json r.json".split(" "));
  assert.equal(status, 1);
});

const names = (page: Page) => page.locator("#rows tr th").allTextContents();

test("rows are sorted and filtered, failures first, and the keyboard goes through them", async () => {
  const { page, errors } = await browser.open(address);
  const all = await names(page);
  assert.equal(all.length, 3);
  assert.equal(all[0], "<b>gamma", "a name is text");
  await page.locator("#scroller").focus();
  await page.keyboard.press("ArrowDown");
  const selected = await page.locator('tr[aria-selected="true"] th').textContent();
  assert.equal(await page.locator("#detail h2").textContent(), selected);
  assert.deepEqual(await violations(page), []);
  await page.getByRole("button", { name: "Case", exact: true }).click();
  assert.deepEqual(await names(page), ["<b>gamma", "alpha", "beta"]);
  await page.getByRole("button", { name: "Case", exact: true }).click();
  assert.deepEqual(await names(page), ["beta", "alpha", "<b>gamma"]);
  assert.equal(await page.locator('th[aria-sort="descending"]').textContent(), "Case");
  await page.getByRole("searchbox").fill("ALPHA");
  assert.deepEqual(await names(page), ["alpha"]);
  assert.equal(await page.textContent("#count"), "1 of 3 cases");
  await page.getByRole("searchbox").fill("");
  await page.getByRole("combobox").selectOption("failures");
  assert.deepEqual(await names(page), ["<b>gamma"]);
  await page.getByRole("combobox").selectOption("all");
  await page.getByRole("slider").fill("0");
  assert.deepEqual(await names(page), ["<b>gamma"]);
  assert.deepEqual(errors, []);
});

test("details: pictures with layers, numbers, 3D", async () => {
  const { page, errors } = await browser.open(address);
  await page.getByRole("button", { name: "alpha", exact: true }).click();
  const pre = await page.locator("#detail pre").textContent();
  const { matrix } = results("r.json").alpha as { matrix: number[] };
  assert.deepEqual(
    (pre ?? "").trim().split(/\s+/).map(Number),
    matrix.map((_, i) => Number((matrix[4 * (i % 4) + Math.floor(i / 4)] as number).toFixed(6))),
  );
  const layer = page.locator('img[data-layer="residual"]');
  assert.equal(await layer.isVisible(), false);
  await page.getByLabel("Depth difference", { exact: true }).check();
  assert.equal(await layer.isVisible(), true);
  await page.waitForFunction(() =>
    Array.from(document.images).every((image) => image.complete && image.naturalWidth > 0),
  );
  const drawn = () =>
    page.locator("canvas").evaluate((canvas: HTMLCanvasElement) => {
      const gl = canvas.getContext("webgl2") as WebGL2RenderingContext;
      const pixels = new Uint8Array(4 * canvas.width * canvas.height);
      gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      // The mesh is orange.
      return pixels.filter((red, i) => i % 4 === 0 && red - (pixels[i + 2] as number) > 60).length;
    });
  const before = await drawn();
  assert.ok(before > 1000, `${before} pixels of the mesh`);
  await page.locator("canvas").press("+");
  await page.locator("canvas").press("ArrowLeft");
  assert.ok((await drawn()) > before, "nearer");
  await page.getByRole("button", { name: "<b>gamma", exact: true }).click();
  assert.match((await page.textContent("#detail .problem")) ?? "", /FILE_NOT_FOUND/);
  assert.deepEqual(errors, []);
});
