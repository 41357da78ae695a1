/** Chromium and Firefox, driven alike, with the built page from the point of view of a user. */

import puppeteer, { type Browser, type BrowserContext, type Page } from "puppeteer-core";
import type { Files } from "./page-files.js";
import { PATIENCE } from "./site.js";

const programs = { chrome: process.env.CHROMIUM_PATH, firefox: process.env.FIREFOX_PATH };
export type BrowserName = keyof typeof programs;
export const browserNames = Object.keys(programs) as BrowserName[];

/** Why tests in a browser are skipped; false if they run. */
export const skipped = (name: BrowserName): string | false =>
  programs[name]
    ? false
    : `No ${name}. Remedy: install it, or name it in ${name === "chrome" ? "CHROMIUM" : "FIREFOX"}_PATH.`;

export function launch(name: BrowserName): Promise<Browser> {
  const args = name === "chrome" ? ["--no-sandbox", "--no-first-run", "--disable-quic"] : [];
  return puppeteer.launch({
    browser: name,
    executablePath: programs[name] ?? "",
    headless: true,
    args,
    timeout: 120_000,
  });
}

/** A tab, and the errors of its scripts, a list that grows. */
export class Tab {
  readonly errors: string[] = [];

  private constructor(readonly page: Page) {
    page.on("pageerror", (error) => this.errors.push(`${error}`));
    page.on("console", (message) => {
      if (message.type() === "error") this.errors.push(message.text());
    });
  }

  /** Opens a tab in a context, whose tabs share what the browser keeps. */
  static async open(context: BrowserContext, url: string): Promise<Tab> {
    const page = await context.newPage();
    await page.setViewport({ width: 1280, height: 800 }).catch((error: unknown) => {
      // Puppeteer also sets the orientation of the screen, which Firefox 140 does not know.
      if (!`${error}`.includes("unknown command emulation.setScreenOrientationOverride")) throw error;
    });
    const tab = new Tab(page);
    await page.goto(url);
    return tab;
  }

  /** Waits for an element that contains a text. */
  async has(selector: string, text = /(?:)/): Promise<void> {
    const isThere = (selector: string, pattern: string) =>
      [...document.querySelectorAll(selector)].some(({ textContent }) => new RegExp(pattern).test(textContent ?? ""));
    await this.page.waitForFunction(isThere, PATIENCE, selector, text.source);
  }

  /** The text of the first such element. */
  text = (selector: string): Promise<string> => this.page.$eval(selector, ({ textContent }) => textContent ?? "");

  /** Waits until an object is aligned and its metrics are known. */
  async aligned(): Promise<number> {
    await this.has("#status:not(.behind)", /^Aligned/);
    const cell = '[data-metric="iou"]:not([data-value=""])';
    await this.has(cell);
    return this.page.$eval(cell, (one) => Number(one.getAttribute("data-value")));
  }

  /** Clicks a control, also one behind a disclosure, as soon as it is there. */
  async click(selector: string): Promise<void> {
    await this.has(selector);
    await this.page.$eval(selector, (one) => (one as HTMLElement).click());
  }

  /** Clicks the button with exactly this name, as soon as it is there. */
  async press(button: string): Promise<void> {
    const click = (name: string) => {
      const buttons = [...document.querySelectorAll("button")];
      const named = buttons.find((one) => (one.getAttribute("aria-label") ?? one.textContent?.trim()) === name);
      named?.click();
      return named !== undefined;
    };
    await this.page.waitForFunction(click, PATIENCE, button);
  }

  async drop(dropped: Files): Promise<void> {
    const encoded = Object.entries(dropped).map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]);
    await this.page.evaluate((parts) => {
      const dataTransfer = new DataTransfer();
      for (const [name = "", base64 = ""] of parts)
        dataTransfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    }, encoded);
  }

  /** Waits until the browser has kept everything. */
  async kept(): Promise<void> {
    await this.page.waitForFunction(() => dispatchEvent(new Event("beforeunload", { cancelable: true })), PATIENCE);
  }
}
