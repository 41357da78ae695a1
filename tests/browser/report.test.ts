/** The page of `align --report`, opened from disk. */
import assert from "node:assert/strict";
import { join } from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import type { Page } from "playwright-core";
import { browserFor, violations } from "../support/browser.js";
import { files, folder, run, writeCase } from "../support/command-line.js";

const address = pathToFileURL(join(folder, "report", "index.html")).href;

const browser = browserFor(folder);
before(() => {
  for (const name of ["alpha", "beta"]) writeCase(name, files);
  const { "mask.png": _, ...incomplete } = files;
  writeCase("<b>gamma", incomplete);
  const names = ["alpha", "beta", "<b>gamma"];
  const { status } = run("align", ...names, ..."--quality fast --report report".split(" "));
  assert.equal(status, 1);
});

const names = (page: Page) => page.locator("tbody th").allTextContents();

test("rows are sorted, failures first; pictures are shown, and messages open", async () => {
  const { page, errors } = await browser.open(address);
  const all = await names(page);
  assert.equal(all.length, 3);
  assert.equal(all[0], "<b>gamma", "a name is text");
  assert.deepEqual(await violations(page), []);
  await page.getByRole("button", { name: "Case", exact: true }).click();
  assert.deepEqual(await names(page), ["<b>gamma", "alpha", "beta"]);
  await page.getByRole("button", { name: "Case", exact: true }).click();
  assert.deepEqual(await names(page), ["beta", "alpha", "<b>gamma"]);
  assert.equal(await page.locator('th[aria-sort="descending"]').textContent(), "Case");
  await page.waitForFunction(() =>
    Array.from(document.images).every((image) => image.complete && image.naturalWidth > 0),
  );
  assert.equal(await page.locator("img").count(), 6);
  await page.getByText("FILE_NOT_FOUND").click();
  assert.match((await page.textContent("details[open]")) ?? "", /mask/);
  assert.deepEqual(errors, []);
});
