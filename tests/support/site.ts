/** Tests of the built page in a browser. */
import assert from "node:assert/strict";
import { join } from "node:path";
import { type TestContext, test } from "node:test";
import type { BrowserContextOptions, Locator, Page } from "playwright-core";
import { violations } from "./axe.js";
import { browserFor, WITHOUT_3D } from "./browser.js";
import { repository } from "./environment.js";

/** Output of `npm run build:www`. */
export const siteDir = join(repository, "target", "www");

/** Time limit for anything that a busy machine may be slow at. */
export const PATIENCE = { timeout: 120_000 };

/** Repeats a measurement until it is as wanted: how long software renderers and databases take is unknown. */
export async function until<T>(measure: () => Promise<T>, isWanted: (found: T) => boolean): Promise<T> {
  for (const end = Date.now() + PATIENCE.timeout; ; ) {
    const found = await measure();
    if (isWanted(found)) return found;
    assert.ok(Date.now() < end, String(found).slice(0, 200));
  }
}

/** A gate for the messages of workers: while it is closed, they wait. */
interface WorkerGate {
  close(): void;
  open(): void;
}

declare global {
  var workerGate: WorkerGate;
}

/** Runs in the page: replaces `Worker` by one whose messages wait for the gate. */
function installWorkerGate(): void {
  let isOpen = true;
  let isPassing = false;
  const waiting: (() => void)[] = [];
  const Plain = Worker;
  globalThis.Worker = class extends Plain {
    constructor(...parameters: ConstructorParameters<typeof Plain>) {
      super(...parameters);
      // The first listener of the worker, so that it can hold messages back from all others.
      this.addEventListener("message", (event) => {
        if (isPassing || (isOpen && waiting.length === 0)) return;
        event.stopImmediatePropagation();
        waiting.push(() => this.dispatchEvent(new MessageEvent("message", { data: event.data })));
      });
    }
  };
  globalThis.workerGate = {
    close() {
      isOpen = false;
    },
    open() {
      isOpen = true;
      // Each message in its own task, in order, as without the gate.
      const next = () => {
        if (!isOpen || waiting.length === 0) return;
        isPassing = true;
        waiting.shift()?.();
        isPassing = false;
        setTimeout(next);
      };
      next();
    },
  };
}

/** How a test opens the page: an address, by default that of the sample of one object, and settings of the browser. */
interface Visit extends BrowserContextOptions {
  address?: string;
  /** Whether the test begins before the first alignment has ended. */
  isLoading?: boolean;
  /** Why the test is skipped. */
  skip?: string | false;
}

type Work = (opened: SitePage, page: Page, t: TestContext) => Promise<void>;

/** Tests in one browser with these flags. Each opens the page below a path, as on many static hosts, in a context of its own. */
export function pageTests(flags: readonly string[] = WITHOUT_3D) {
  const browser = browserFor(join(repository, "target"), flags);
  return (title: string, ...parameters: [Work] | [string | Visit, Work]) => {
    const [visit, work] = parameters.length === 1 ? [{}, ...parameters] : parameters;
    const given = typeof visit === "string" ? { address: visit } : visit;
    const { address = "#sample=mug", isLoading = false, skip = false, ...context }: Visit = given;
    test(title, { skip }, async (t) => {
      const { page, errors } = await browser.open(
        `www/index.html${address}`,
        { serviceWorkers: "block", ...context },
        installWorkerGate,
      );
      const opened = new SitePage(page, errors);
      if (!isLoading) await opened.aligned();
      await work(opened, page, t);
      assert.deepEqual(errors, []);
      await page.close();
    });
  };
}

/** The pixels of an image: red, green, blue, alpha. */
export interface Pixels {
  width: number;
  height: number;
  data: Buffer;
}

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
    await cell.waitFor(PATIENCE);
    return Number(await cell.getAttribute("data-value"));
  }

  /** The displayed size in centimetres. */
  async dimensions(): Promise<number[]> {
    const text = (await this.page.textContent("#dimensions")) ?? "";
    return Array.from(text.matchAll(/[\d.]+/g), Number);
  }

  /** The origin of the current pose. */
  source(): Promise<string | null> {
    return this.page.getAttribute(".result", "data-source");
  }

  /** Waits for a pose of this origin. */
  async isNow(source: string): Promise<void> {
    await this.page.locator(`.result[data-source="${source}"]`).waitFor(PATIENCE);
  }

  /** Waits for the 3D view, drawn with this interface. */
  has3d(backend: "webgpu" | "webgl"): Promise<void> {
    return this.page.locator(`.view-host[data-backend="${backend}"] canvas`).waitFor(PATIENCE);
  }

  /** Shows a control that is behind a disclosure or in a menu, uses it, and closes the menu. */
  private async reveal(control: Locator, use: () => Promise<void>): Promise<void> {
    const menu = await control.evaluateHandle((one) => {
      for (let at = one.closest("details"); at != null; at = at.parentElement?.closest("details") ?? null)
        at.open = true;
      const menu = one.closest<HTMLElement>("[popover]");
      menu?.showPopover();
      return menu;
    });
    await use();
    await menu.evaluate((menu) => menu?.hidePopover());
  }

  /** Shows or hides a layer of the image. */
  async showInImage(layer: "outline" | "silhouette" | "zoom", isShown: boolean): Promise<void> {
    const box = this.page.locator(`#layer-${layer}`);
    await this.reveal(box, () => box.setChecked(isShown));
  }

  /** Chooses from a list, wherever it is. */
  async choose(list: string, value: string): Promise<void> {
    const found = this.page.locator(list);
    await this.reveal(found, async () => void (await found.selectOption(value)));
  }

  /** Clicks the button with exactly this name, wherever it is. */
  async press(button: string): Promise<void> {
    const found = this.page.getByRole("button", { name: button, exact: true, includeHidden: true });
    await this.reveal(found, () => found.click());
  }

  /** Clicks a control, wherever it is. */
  async click(control: string): Promise<void> {
    const found = this.page.locator(control);
    await this.reveal(found, () => found.click());
  }

  /** Enters a number in a field, wherever it is. */
  async enter(field: string, value: string): Promise<void> {
    const found = this.page.locator(field);
    await this.reveal(found, async () => {
      await found.fill(value);
      await found.press("Enter");
    });
  }

  /** Holds back all messages of workers, so that a running alignment does not end. */
  async closeWorkerGate(): Promise<void> {
    await this.page.evaluate(() => workerGate.close());
  }

  /** Delivers the messages that were held back, and all later ones. */
  async openWorkerGate(): Promise<void> {
    await this.page.evaluate(() => workerGate.open());
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
  private capture(): Promise<Pixels> {
    return pixelsOf(
      this.page,
      `new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))
        .then(() => document.querySelector(".image canvas").getContext("2d"))`,
    );
  }

  /** Clicks a button that saves a file, and returns the file. */
  async saved(button: string): Promise<{ name: string; bytes: Buffer }> {
    const [download] = await Promise.all([this.page.waitForEvent("download"), this.press(button)]);
    const parts: Buffer[] = [];
    for await (const part of await download.createReadStream()) parts.push(part as Buffer);
    return { name: download.suggestedFilename(), bytes: Buffer.concat(parts) };
  }

  /** The violations that axe finds, one line per rule. */
  violations(): Promise<string[]> {
    return violations(this.page);
  }
}

/** The pixels of a canvas. `context` is a script that resolves to its context. */
async function pixelsOf(page: Page, context: string): Promise<Pixels> {
  const { width, height, data } = (await page.evaluate(`(async () => {
    const context = await ${context};
    return context.getImageData(0, 0, context.canvas.width, context.canvas.height);
  })().then(({ width, height, data }) => ({ width, height, data }))`)) as ImageData;
  return { width, height, data: Buffer.from(data.buffer, data.byteOffset, data.byteLength) };
}
