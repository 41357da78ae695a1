/** Tests of the built page in a browser. */
import assert from "node:assert/strict";
import { join } from "node:path";
import type { BrowserContextOptions, Locator, Page } from "playwright-core";
import { violations } from "./axe.js";
import { PageTest } from "./browser.js";
import { repository } from "./environment.js";

/** Output of `npm run build:www`. */
export const siteDir = join(repository, "target", "www");

/** Time limit for anything that a busy machine may be slow at. */
export const PATIENCE = { timeout: 120_000 };

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

/** The built page in a browser. */
export class SiteTest {
  private constructor(private readonly test: PageTest) {}

  /** Starts a browser and serves the page below a path, as many static hosts do. */
  static async start(flags: readonly string[] = []): Promise<SiteTest> {
    return new SiteTest(await PageTest.start(join(repository, "target"), flags));
  }

  /** Opens the page. */
  async visit(address = "", context: BrowserContextOptions = {}): Promise<SitePage> {
    const { page, errors } = await this.test.open(`www/index.html${address}`, context, installWorkerGate);
    return new SitePage(page, errors);
  }

  /** Opens the page with a sample, by default that of one object, and waits until it is aligned. */
  async open(address = "#sample=mug", context: BrowserContextOptions = {}): Promise<SitePage> {
    const site = await this.visit(address, context);
    await site.aligned();
    return site;
  }

  stop(): Promise<void> {
    return this.test.stop();
  }
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
  private async capture(): Promise<Pixels> {
    // As text, which Playwright transfers a hundred times faster than numbers.
    const { width, height, text } = (await this.page.evaluate(`(async () => {
      await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
      const { width, height } = document.querySelector(".image canvas");
      const { data } = document.querySelector(".image canvas").getContext("2d").getImageData(0, 0, width, height);
      const rows = Array.from({ length: height }, (_, v) => data.subarray(4 * v * width, 4 * (v + 1) * width));
      return { width, height, text: btoa(rows.map((row) => String.fromCharCode(...row)).join("")) };
    })()`)) as { width: number; height: number; text: string };
    return { width, height, data: Buffer.from(text, "base64") };
  }

  /** Clicks a button that saves a file, and returns the file. */
  async saved(button: string): Promise<{ name: string; bytes: Buffer }> {
    const [download] = await Promise.all([
      this.page.waitForEvent("download"),
      this.page.getByRole("button", { name: button, exact: true }).click(),
    ]);
    const parts: Buffer[] = [];
    for await (const part of await download.createReadStream()) parts.push(part as Buffer);
    return { name: download.suggestedFilename(), bytes: Buffer.concat(parts) };
  }

  /** The violations that axe finds, one line per rule. */
  violations(): Promise<string[]> {
    return violations(this.page);
  }

  /** Closes the page, which must not have logged errors. */
  async close(): Promise<void> {
    assert.deepEqual(this.errors, []);
    await this.page.close();
  }
}

/** A screenshot of the 3D view. */
export async function spacePixels(page: Page): Promise<Pixels> {
  const png = await page.locator(".space .view-host").screenshot();
  const decoded = (await page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const { width, height } = bitmap;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context?.drawImage(bitmap, 0, 0);
    const { data } = context?.getImageData(0, 0, width, height) ?? { data: new Uint8ClampedArray() };
    const rows = Array.from({ length: height }, (_, v) => data.subarray(4 * v * width, 4 * (v + 1) * width));
    return { width, height, text: btoa(rows.map((row) => String.fromCharCode(...row)).join("")) };
  }, png.toString("base64"))) as { width: number; height: number; text: string };
  return { ...decoded, data: Buffer.from(decoded.text, "base64") };
}
