/** The built page in a browser. */
import assert from "node:assert/strict";
import { join } from "node:path";
import type { BrowserContextOptions, Page } from "playwright-core";
import { PageTest } from "./browser.js";
import { repository } from "./environment.js";

/** Where `npm run build:www` puts it. */
export const siteDir = join(repository, "target", "www");

/** How long a busy machine may take for anything. */
export const PATIENCE = { timeout: 120_000 };

/** The page, in a browser of its own. */
export class SiteTest {
  private constructor(private readonly test: PageTest) {}

  /** Starts a browser, and serves the page below a path, as static hosts do. */
  static async start(flags: readonly string[] = []): Promise<SiteTest> {
    return new SiteTest(await PageTest.start(join(repository, "target"), flags));
  }

  /** Opens the page. */
  async visit(address = "", context: BrowserContextOptions = {}): Promise<SitePage> {
    const { page, errors } = await this.test.open(`www/index.html${address}`, context);
    return new SitePage(page, errors);
  }

  /** Opens the page, and waits until it has aligned its sample. */
  async open(address = "", context: BrowserContextOptions = {}): Promise<SitePage> {
    const site = await this.visit(address, context);
    await site.aligned();
    return site;
  }

  stop(): Promise<void> {
    return this.test.stop();
  }
}

/** A picture's pixels: red, green, blue, opacity. */
export interface Pixels {
  width: number;
  height: number;
  data: Buffer;
}

/** The page as somebody uses it. */
export class SitePage {
  constructor(
    readonly page: Page,
    readonly errors: string[],
  ) {}

  /** Waits for a line that says so. */
  async says(text: RegExp): Promise<string> {
    const status = this.page.locator("#status:not(.behind)").filter({ hasText: text });
    await status.waitFor(PATIENCE);
    return (await status.textContent()) ?? "";
  }

  /** Waits until something has been aligned, and scored. */
  async aligned(): Promise<void> {
    await this.says(/^Aligned/);
    await this.metric("iou");
  }

  /** A metric of the present pose, once it is known. */
  async metric(name: string): Promise<number> {
    const cell = this.page.locator(`[data-metric="${name}"]:not([data-value=""])`);
    await cell.waitFor(PATIENCE);
    return Number(await cell.getAttribute("data-value"));
  }

  /** The sides of the box around the object, in centimetres. */
  async dimensions(): Promise<number[]> {
    const text = (await this.page.textContent("#dimensions")) ?? "";
    return Array.from(text.matchAll(/[\d.]+/g), Number);
  }

  /** What put the mesh where it is. */
  source(): Promise<string | null> {
    return this.page.getAttribute(".result", "data-source");
  }

  /** Waits until the mesh is where something has put it. */
  async isNow(source: string): Promise<void> {
    await this.page.locator(`.result[data-source="${source}"]`).waitFor(PATIENCE);
  }

  /**
   * The image view's pixels, once it keeps still: red, green, blue, opacity.
   *
   * Where a software device goes down under the 3D view, it takes the picture along, which is then drawn again: so the
   * 3D view comes first, and a picture that is empty is none.
   */
  async imagePixels(): Promise<Pixels> {
    await this.page.locator('.space:not([data-state="loading"])').waitFor(PATIENCE);
    let last = await this.glimpse();
    for (let look = 0; look < 40; look++) {
      await this.page.waitForTimeout(150);
      const now = await this.glimpse();
      if (now.data.equals(last.data) && now.data.some((value) => value !== 0)) return now;
      last = now;
    }
    return last;
  }

  private async glimpse(): Promise<Pixels> {
    // As text, which goes between the processes a hundred times faster than numbers.
    const { width, height, text } = (await this.page.evaluate(`(async () => {
      await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
      const { width, height } = document.querySelector(".image canvas");
      const { data } = document.querySelector(".image canvas").getContext("2d").getImageData(0, 0, width, height);
      const rows = Array.from({ length: height }, (_, v) => data.subarray(4 * v * width, 4 * (v + 1) * width));
      return { width, height, text: btoa(rows.map((row) => String.fromCharCode(...row)).join("")) };
    })()`)) as { width: number; height: number; text: string };
    return { width, height, data: Buffer.from(text, "base64") };
  }

  /** Clicks on what saves a file, and returns it. */
  async saved(button: string): Promise<{ name: string; bytes: Buffer }> {
    const [download] = await Promise.all([
      this.page.waitForEvent("download"),
      this.page.getByRole("button", { name: button, exact: true }).click(),
    ]);
    const parts: Buffer[] = [];
    for await (const part of await download.createReadStream()) parts.push(part as Buffer);
    return { name: download.suggestedFilename(), bytes: Buffer.concat(parts) };
  }

  /** Closes it; nothing may have gone wrong unnoticed. */
  async close(): Promise<void> {
    assert.deepEqual(this.errors, []);
    await this.page.close();
  }
}
