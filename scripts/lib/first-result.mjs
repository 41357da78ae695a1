/** Opens the page in a headless Chromium, and waits for the first alignment. */
import { chromium } from "playwright-core";

/** How long a slow machine may take, in milliseconds. */
const LIMIT_MS = 120_000;

/**
 * What the page says of its first sample.
 * @param {string} executablePath of Chromium
 * @param {string} url
 * @returns {Promise<{ status: string, dimensions: string, confidence: string, milliseconds: number }>} the time is from
 * the beginning of the navigation to the result's being shown
 */
export async function firstResult(executablePath, url) {
  const browser = await chromium.launch({ executablePath, headless: true, args: ["--no-sandbox", "--no-first-run"] });
  try {
    const page = await browser.newPage();
    await page.goto(url);
    const done = page.locator('#status:is([data-state="done"], [data-state="failed"]):not(.behind)');
    await done.filter({ hasText: /Aligned|:/ }).waitFor({ timeout: LIMIT_MS });
    await page.locator("#dimensions").waitFor({ timeout: LIMIT_MS });
    const milliseconds = await page.evaluate(() => performance.getEntriesByName("aligned")[0]?.startTime ?? 0);
    const text = async (/** @type {string} */ selector) => (await page.textContent(selector))?.trim() ?? "";
    const [status, dimensions, confidence] = await Promise.all(["#status", "#dimensions", "#confidence"].map(text));
    return { status: status ?? "", dimensions: dimensions ?? "", confidence: confidence ?? "", milliseconds };
  } finally {
    await browser.close();
  }
}
