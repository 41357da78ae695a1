/** Tests of the built page in a browser. */
import assert from "node:assert/strict";
import { join } from "node:path";
import { type TestContext, test } from "node:test";
import type { BrowserContextOptions, Locator, Page } from "playwright-core";
import { browserFor, PATIENCE, violations, WITHOUT_3D } from "./browser.js";
import { repository } from "./environment.js";

export { PATIENCE };

/** Output of `npm run build:www`. */
export const siteDir = join(repository, "target", "www");

/** Repeats a measurement until it is as wanted: how long software renderers and databases take is unknown. */
export async function until<T>(measure: () => Promise<T>, isWanted: (found: T) => boolean): Promise<T> {
  for (const end = Date.now() + PATIENCE.timeout; ; ) {
    const found = await measure();
    if (isWanted(found)) return found;
    assert.ok(Date.now() < end, String(found).slice(0, 200));
  }
}

/** How a test opens the page: an address, by default that of the sample of one object, and settings of the browser. */
interface Visit extends BrowserContextOptions {
  address?: string;
  /** Whether the test begins before the first alignment has ended. */
  isLoading?: boolean;
}

type Work = (opened: SitePage, page: Page, t: TestContext) => Promise<void>;

/** Tests in one browser with these flags. Each opens the page below a path, as on many static hosts, in a context of its own. */
export function pageTests(flags: readonly string[] = WITHOUT_3D) {
  const browser = browserFor(join(repository, "target"), flags);
  return (title: string, ...parameters: [Work] | [string | Visit, Work]) => {
    const [visit, work] = parameters.length === 1 ? [{}, ...parameters] : parameters;
    const given = typeof visit === "string" ? { address: visit } : visit;
    const { address = "#sample=mug", isLoading = false, ...context }: Visit = given;
    test(title, async (t) => {
      const { page, errors } = await browser.open(`www/index.html${address}`, { serviceWorkers: "block", ...context });
      const opened = new SitePage(page, errors);
      if (!isLoading) await opened.aligned();
      await work(opened, page, t);
      assert.deepEqual(errors, []);
      await page.close();
    });
  };
}

/** The pixels of an image: red, green, blue, alpha. */
type Pixels = { width: number; height: number; data: Buffer };

/** The page from the point of view of a user. */
export class SitePage {
  constructor(
    readonly page: Page,
    readonly errors: string[],
  ) {}

  /** Waits for a text in the status line. */
  async says(text: RegExp): Promise<string> {
    const status = this.page.locator("#status:not(.behind)").filter({ hasText: text });
    await status.waitFor(PATIENCE);
    return (await status.textContent()) ?? "";
  }

  /** Waits until an object is aligned and its metrics are known. */
  async aligned(): Promise<void> {
    await this.says(/^Aligned/);
    await this.metric("iou");
  }

  /** Waits until a scene with this name is shown and aligned. */
  async shows(scene: string): Promise<void> {
    await this.page.locator(`main[data-scene="${scene}"]`).waitFor(PATIENCE);
    await this.aligned();
  }

  /** The intake sheet, once its files are read. */
  async sheet(): Promise<Locator> {
    const sheet = this.page.locator(".intake");
    await sheet.locator("footer [role=status]:not(:has-text('Reading'))").waitFor(PATIENCE);
    return sheet;
  }

  /** Waits for a metric of the current pose. */
  async metric(name: string): Promise<number> {
    const cell = this.page.locator(`[data-metric="${name}"]:not([data-value=""])`);
    // Most are behind a disclosure.
    await cell.waitFor({ state: "attached", ...PATIENCE });
    return Number(await cell.getAttribute("data-value"));
  }

  /** The displayed size in centimetres. */
  async dimensions(): Promise<number[]> {
    const text = (await this.page.textContent("#dimensions")) ?? "";
    return Array.from(text.matchAll(/[\d.]+/g), Number);
  }

  /** The origin of the current pose. */
  source = () => this.page.getAttribute(".result", "data-source");

  /** Waits for a pose of this origin. */
  isNow = (source: string) => this.page.locator(`.result[data-source="${source}"]`).waitFor(PATIENCE);

  /** Shows a control that is behind a disclosure or in a menu, uses it, and closes the menu. */
  async reveal(control: Locator, use: (control: Locator) => Promise<unknown>): Promise<void> {
    const menu = await control.evaluateHandle((one) => {
      for (let at = one.closest("details"); at != null; at = at.parentElement?.closest("details") ?? null)
        at.open = true;
      const menu = one.closest<HTMLElement>("[popover]");
      menu?.showPopover();
      return menu;
    });
    await use(control);
    await menu.evaluate((menu) => menu?.hidePopover());
  }

  /** Shows or hides a layer of the image. */
  showInImage = (layer: "outline" | "silhouette", isShown: boolean) =>
    this.reveal(this.page.locator(`#layer-${layer}`), (box) => box.setChecked(isShown));

  /** Chooses from a list, wherever it is. */
  choose = (list: string, value: string) => this.reveal(this.page.locator(list), (found) => found.selectOption(value));

  /** Chooses a sample. */
  sample = (id: string) => this.click(`[data-sample="${id}"]`);

  /** Clicks a control, wherever it is. */
  click = (control: string) => this.reveal(this.page.locator(control), (found) => found.click());

  /** Clicks the button with exactly this name, wherever it is. */
  press(name: string): Promise<void> {
    const button = this.page.getByRole("button", { name, exact: true, includeHidden: true });
    return this.reveal(button, () => button.click());
  }

  /** Enters a number in a field, wherever it is. */
  enter(field: string, value: string): Promise<void> {
    return this.reveal(this.page.locator(field), async (found) => {
      await found.fill(value);
      await found.press("Enter");
    });
  }

  /**
   * The pixels of the image view.
   *
   * If a software device fails while the 3D view starts, the browser clears the image, and the page draws it again. So
   * this waits for the 3D view, and for an image that is not empty.
   */
  async imagePixels(): Promise<Pixels> {
    await this.page.locator('.space:not([data-state="loading"])').waitFor(PATIENCE);
    for (;;) {
      const pixels = await this.capture();
      if (pixels.data.some((value) => value !== 0)) return pixels;
    }
  }

  /** The pixels after all changes so far were drawn, which takes the page one frame. */
  private async capture(): Promise<Pixels> {
    const { width, height, data } = (await this.page.evaluate(`new Promise((resolve) =>
      requestAnimationFrame(() => requestAnimationFrame(resolve))).then(() => {
        const context = document.querySelector(".image canvas").getContext("2d");
        const { width, height, data } = context.getImageData(0, 0, context.canvas.width, context.canvas.height);
        return { width, height, data };
      })`)) as ImageData;
    return { width, height, data: Buffer.from(data.buffer, data.byteOffset, data.byteLength) };
  }

  /** Clicks a button that saves a file, and returns the file. */
  async saved(button: string): Promise<{ name: string; bytes: Buffer }> {
    const [download] = await Promise.all([this.page.waitForEvent("download"), this.press(button)]);
    const parts: Buffer[] = [];
    for await (const part of await download.createReadStream()) parts.push(part as Buffer);
    return { name: download.suggestedFilename(), bytes: Buffer.concat(parts) };
  }

  /** Whether leaving the page would ask, because some work is not stored yet. */
  asks(): Promise<boolean> {
    return this.page.evaluate(() => !dispatchEvent(new Event("beforeunload", { cancelable: true })));
  }

  /** Waits until the browser has stored everything. */
  async kept(): Promise<void> {
    await until(
      () => this.asks(),
      (asks) => !asks,
    );
  }

  /** The violations that axe finds, one line per rule. */
  violations = () => violations(this.page);
}
