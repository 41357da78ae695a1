/** Aligning: progress, cancelling, several objects, alternatives, invalid options. */
import assert from "node:assert/strict";
import { PATIENCE, pageTests } from "../support/site.js";

const test = pageTests();

/** Runs in the page: messages to workers wait, so that an alignment does not end. The function it leaves sends them. */
function holdMessages(): void {
  const { postMessage } = Worker.prototype;
  const waiting: (() => void)[] = [];
  Worker.prototype.postMessage = function (this: Worker, ...message: unknown[]) {
    waiting.push(() => Reflect.apply(postMessage, this, message));
  };
  globalThis.sendMessages = () => {
    Worker.prototype.postMessage = postMessage;
    for (const send of waiting) send();
  };
}

declare global {
  var sendMessages: () => void;
}

test("an alignment can be cancelled, by button and by key, and started again", "#sample=desk", async (opened, page) => {
  const before = await opened.dimensions();
  await page.evaluate(holdMessages);
  await page.click("#align-all");
  await page.locator("#cancel").click(PATIENCE);
  await opened.says(/^Cancelled/);
  assert.deepEqual(await opened.dimensions(), before);
  await page.click("#align-all");
  await page.locator("#cancel").waitFor(PATIENCE);
  await page.keyboard.press("Escape");
  await opened.says(/^Cancelled/);
  await page.evaluate(() => sendMessages());
  await page.keyboard.press("a");
  await opened.aligned();
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
  assert.match((await page.textContent(".result .error")) ?? "", /^scale: Found \[3, 2\]/);
  await page.click(".options-panel summary");
  for (const name of ["scaleMin", "scaleMax"]) await page.fill(`#option-${name}`, "");
  await page.click("#align-all");
  await opened.aligned();
});
