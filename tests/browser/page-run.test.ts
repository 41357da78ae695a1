/** Aligning: progress, cancelling, several objects, alternatives, invalid options. */
import assert from "node:assert/strict";
import { PATIENCE, pageTests } from "../support/site.js";

const test = pageTests();

test("an alignment can be cancelled, by button and by key, and started again", "#sample=desk", async (opened, page) => {
  const before = await opened.dimensions();
  await opened.closeWorkerGate();
  await page.click("#align-all");
  await page.locator("#cancel").click(PATIENCE);
  await opened.says(/^Cancelled/);
  assert.deepEqual(await opened.dimensions(), before);
  await page.click("#align-all");
  await page.locator("#cancel").waitFor(PATIENCE);
  await page.keyboard.press("Escape");
  await opened.says(/^Cancelled/);
  await opened.openWorkerGate();
  await page.keyboard.press("a");
  await opened.aligned();
});

const best = "#sample=mug&quality=best";
test("the page responds during an alignment, and shows its progress", best, async (opened, page) => {
  await page.evaluate(() => {
    const seen: number[] = [];
    Object.assign(globalThis, { seen });
    const progress = document.querySelector("#progress") as HTMLProgressElement;
    new MutationObserver(() => {
      if (document.querySelector("#cancel") !== null) seen.push(progress.value);
    }).observe(progress, { attributes: true });
  });
  await opened.closeWorkerGate();
  await page.click("#align");
  await page.locator("#cancel").waitFor(PATIENCE);
  await page.keyboard.press("d");
  await page.locator("#layer-difference:checked").waitFor({ state: "attached", ...PATIENCE });
  assert.ok(await page.isVisible("#cancel"));
  await opened.openWorkerGate();
  await opened.aligned();
  const values = (await page.evaluate("seen")) as number[];
  assert.ok(new Set(values).size > 2, `progress: ${[...new Set(values)]}`);
  assert.deepEqual(
    values,
    [...values].sort((a, b) => a - b),
  );
});

test("several objects of one scene are aligned, each with its own result", "#sample=desk", async (opened, page) => {
  const rows = page.locator(".objects .select");
  assert.equal(await rows.count(), 3);
  const seen = new Set<string>();
  for (let i = 0; i < 3; i++) {
    await rows.nth(i).click();
    assert.equal(await rows.nth(i).getAttribute("aria-pressed"), "true");
    seen.add((await opened.dimensions()).join());
    assert.match((await rows.nth(i).textContent()) ?? "", /\d %$/);
  }
  assert.equal(seen.size, 3);
  await page.click("#align-all");
  await opened.says(/^Aligned 3 objects/);
});

const turned = "#sample=desk&symmetry=none";
test(
  "alternatives are pictures of poses that can be chosen, and the result can be restored",
  turned,
  async (opened, page) => {
    // Alone, the box could be turned; the others tell how it stands.
    await opened.press("Align this object");
    await page.locator("#cancel").waitFor({ state: "detached" });
    await opened.aligned();
    const buttons = page.locator(".alternatives button");
    assert.ok((await buttons.count()) > 1, "the box has no alternative");
    // The pictures are drawn a little later than the result is shown.
    const areDifferent = () => {
      const all = [...document.querySelectorAll<HTMLCanvasElement>(".alternatives canvas")];
      return all.length > 1 && new Set(all.map((one) => one.toDataURL())).size === all.length;
    };
    await page.waitForFunction(areDifferent, undefined, PATIENCE);
    const iou = await opened.metric("iou");
    await page.keyboard.press("1");
    await opened.isNow("alternative");
    const other = await opened.metric("iou");
    assert.ok(other > 0 && other !== iou, `${other} and ${iou}`);
    await buttons.first().click();
    await opened.isNow("aligned");
    assert.equal(await opened.metric("iou"), iou);
  },
);

const contradictory = { address: "#scaleMin=3&scaleMax=2", isLoading: true };
test("contradictory options show the error of the library", contradictory, async (opened, page) => {
  await opened.says(/scale/);
  assert.match((await page.textContent(".result .error")) ?? "", /options\.scale/);
  await page.click(".options-panel summary");
  for (const name of ["scaleMin", "scaleMax"]) await page.fill(`#option-${name}`, "");
  await page.click("#align-all");
  await opened.aligned();
});
