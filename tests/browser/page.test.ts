import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { PageTest } from "../support/browser.js";

let browser: PageTest;
before(async () => {
  browser = await PageTest.start();
});
after(() => browser?.stop());

test("the page aligns the sample and shows transform, metrics and times", async () => {
  const { page, errors } = await browser.open("www/index.html");
  await page.waitForSelector('#status:is([data-state="done"], [data-state="failed"])', { timeout: 120_000 });
  assert.equal(await page.textContent("#status"), "Aligned.");
  assert.ok(await page.isVisible("#result"));

  const rows = (id: string) =>
    page.$$eval(`#${id} tr`, (found: HTMLTableRowElement[]) =>
      found.map((row) => [row.cells[0]?.textContent ?? "", row.cells[1]?.textContent ?? ""]),
    );
  const transform = new Map((await rows("transform")) as [string, string][]);
  assert.ok(Number(transform.get("scale")) > 0, `scale: ${transform.get("scale")}`);
  const numbers = (text: string | undefined) => (text ?? "").split(", ").map(Number);
  const quaternion = numbers(transform.get("rotation (quaternion x, y, z, w)"));
  assert.equal(quaternion.length, 4);
  assert.ok(Math.abs(Math.hypot(...quaternion) - 1) < 1e-3, `rotation: ${quaternion}`);
  const translation = numbers(transform.get("translation (m)"));
  assert.ok(translation.length === 3 && translation.every(Number.isFinite), `translation: ${translation}`);

  const confidence = transform.get("confidence") ?? "";
  assert.ok(confidence === "–" || (Number(confidence) >= 0 && Number(confidence) <= 1), `confidence: ${confidence}`);
  assert.match(transform.get("alternatives") ?? "", /^\d+$/);

  const metrics = new Map((await rows("metrics")) as [string, string][]);
  const iou = Number(metrics.get("iou"));
  assert.ok(iou > 0 && iou <= 1, `iou: ${iou}`);
  assert.ok((await rows("timings")).length > 0);
  assert.deepEqual(errors, []);
});
