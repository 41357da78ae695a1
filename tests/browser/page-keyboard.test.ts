/** The annotator's loop without a mouse: open, look through, correct, decide, save. */
import assert from "node:assert/strict";
import { cp, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { repository } from "../support/environment.js";
import { PATIENCE, pageTests, until } from "../support/site.js";

const test = pageTests();

test(
  "scenes are opened, corrected, accepted and saved by keyboard",
  "#sample=mug&quality=fast",
  async (opened, page, t) => {
    const press = async (...keys: string[]) => {
      for (const key of keys) await page.keyboard.press(key);
    };
    const button = (name: string) => page.getByRole("button", { name, exact: true });
    const saved = async (format: string) => {
      const [download] = await Promise.all([page.waitForEvent("download"), button(format).press("Enter")]);
      return download.suggestedFilename();
    };
    const width = async () => Math.max(...(await opened.dimensions()));
    const title = async () => (await page.textContent("#result-title"))?.trim();
    const focused = () => page.evaluate(() => document.activeElement?.textContent ?? "");

    const folder = await mkdtemp(join(tmpdir(), "scenes-"));
    t.after(() => rm(folder, { recursive: true }));
    for (const name of ["hammer", "table"])
      await cp(join(repository, "www", "samples", name), join(folder, name), { recursive: true });
    const chooser = page.waitForEvent("filechooser");
    await page.locator("#folder").press("Space");
    await (await chooser).setFiles(folder);
    // The sheet offers what comes next.
    await page.locator("#intake-open:focus").waitFor(PATIENCE);
    await press("Enter");
    await opened.shows("hammer");

    // The arrow keys do what the handles do. While one is held down, it is one step.
    const [size, overlap] = [await width(), await opened.metric("iou")];
    await press("g", "ArrowLeft", "PageUp", "r", "ArrowDown", "PageDown", "s", "ArrowRight");
    await opened.isNow("hand");
    const larger = await width();
    assert.ok(Math.abs(larger / size - 1.02) < 0.01, `${size}, then ${larger} cm`);
    for (let i = 0; i < 4; i++) await page.keyboard.down("ArrowLeft");
    await page.keyboard.up("ArrowLeft");
    assert.ok((await width()) < 0.95 * larger);
    await press("Control+z");
    assert.equal(await width(), larger);
    await press("Escape", "ArrowLeft");
    assert.equal(await width(), larger);
    // Keys that come at once count in their order: without handles, an arrow changes nothing.
    await page.evaluate(() => {
      for (const key of ["s", "ArrowRight", "Escape", "ArrowLeft"])
        document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    });
    const largest = await width();
    assert.ok(Math.abs(largest / larger - 1.02) < 0.01, `${larger}, then ${largest} cm`);
    await until(
      () => opened.metric("iou"),
      (now) => now < overlap - 0.02,
    );

    await press("f");
    await opened.isNow("refined");
    // With Caps Lock, the letter is a capital.
    await press("Control+Z");
    await opened.isNow("hand");
    await press("Control+Shift+z");
    await opened.isNow("refined");
    await until(
      () => opened.metric("iou"),
      (now) => now > overlap - 0.02,
    );
    await press("Enter");
    await opened.says(/All objects are accepted/);

    await press("n");
    await opened.shows("table");
    // The object that waits is selected, which depends on what has been aligned by now.
    for (let i = 0; i < 3 && (await title()) !== "box"; i++) await press("j");
    const names = [await title()];
    for (let i = 1; i < 3; i++) {
      await press("j");
      names.push(await title());
    }
    assert.deepEqual(names, ["box", "mug", "teapot"]);
    // The focus goes on with the object that was renamed, and shows.
    await page.locator('.objects .select[aria-pressed="true"]').press("F2");
    await page.keyboard.type("Pot");
    await press("Enter");
    await page.locator(".objects .select:focus-visible", { hasText: "Pot" }).waitFor(PATIENCE);
    await press("Control+Enter");
    await opened.says(/^Accepted Pot/);
    for (const name of ["box", "mug"]) {
      assert.equal(await title(), name);
      assert.match(await focused(), /Pot/);
      await press("Control+Enter");
    }
    await opened.says(/All objects are accepted/);
    assert.equal(await saved("JSON"), "table.json");
    await button("More formats").press("Enter");
    assert.equal(await saved("GLB"), "mug-placed.glb");
    // Nothing below the window, to which the arrows could scroll.
    assert.equal(await page.evaluate(() => document.documentElement.scrollHeight - innerHeight), 0);
  },
);
