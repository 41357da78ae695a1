/** The built page in Firefox, from the point of view of a user. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import type { Page } from "puppeteer-core";
import { FirefoxTest, skipFirefox } from "./firefox.js";
import type { Files } from "./page-files.js";
import { PATIENCE, siteDir } from "./site.js";

export class FirefoxPage {
  constructor(
    readonly page: Page,
    readonly errors: string[],
  ) {}

  /** Waits for an element that contains a text. */
  async has(selector: string, text = /(?:)/): Promise<void> {
    const isThere = (selector: string, pattern: string) =>
      [...document.querySelectorAll(selector)].some(({ textContent }) => new RegExp(pattern).test(textContent ?? ""));
    try {
      await this.page.waitForFunction(isThere, PATIENCE, selector, text.source);
    } catch (cause) {
      const found = await this.texts(`${selector}, #status, .intake [role=alert]`);
      throw new Error(`No ${selector} with ${text}, but ${JSON.stringify(found).slice(0, 500)}`, { cause });
    }
  }

  /** Waits until no element is found. */
  async hasNo(selector: string): Promise<void> {
    await this.page.waitForFunction((selector) => document.querySelector(selector) === null, PATIENCE, selector);
  }

  /** Waits for a text in the status line. */
  says = (text: RegExp) => this.has("#status:not(.behind)", text);

  /** Waits until an object is aligned and its metrics are known. */
  async aligned(): Promise<void> {
    await this.says(/^Aligned/);
    await this.metric("iou");
  }

  isShown = (scene: string) => this.has(`main[data-scene="${scene}"]`);

  /** Waits until a scene with this name is shown and aligned. */
  async shows(scene: string): Promise<void> {
    await this.isShown(scene);
    await this.aligned();
  }

  /** Waits until the intake sheet has read its files. */
  sheet = () => this.has(".intake footer [role=status]", /^(?!Reading)/);

  /** Waits for a pose of this origin. */
  isNow = (source: string) => this.has(`.result[data-source="${source}"]`);

  /** The text of the first such element, which is there. */
  text = (selector: string): Promise<string> => this.page.$eval(selector, ({ textContent }) => textContent ?? "");

  /** The texts of all such elements. */
  texts = (selector: string): Promise<string[]> =>
    this.page.$$eval(selector, (all) => all.map(({ textContent }) => textContent ?? ""));

  count = (selector: string): Promise<number> => this.page.$$eval(selector, ({ length }) => length);

  /** Waits for a metric of the current pose. */
  async metric(name: string): Promise<number> {
    const cell = `[data-metric="${name}"]:not([data-value=""])`;
    await this.has(cell);
    return this.page.$eval(cell, (one) => Number(one.getAttribute("data-value")));
  }

  /** The displayed size in centimetres. */
  dimensions = async (): Promise<number[]> =>
    Array.from((await this.text("#dimensions")).matchAll(/[\d.]+/g), ([number]) => Number(number));

  /** Clicks a control, also one behind a disclosure, as soon as it is there. */
  async click(selector: string): Promise<void> {
    await this.has(selector);
    await this.page.$eval(selector, (one) => (one as HTMLElement).click());
  }

  /** Clicks the button with exactly this name, as soon as it is there. */
  async press(button: string): Promise<void> {
    const click = (name: string) => {
      const named = [...document.querySelectorAll("button")].find(
        (one) => (one.getAttribute("aria-label") ?? one.textContent?.trim()) === name,
      );
      named?.click();
      return named !== undefined;
    };
    await this.page.waitForFunction(click, PATIENCE, button);
  }

  /** Types a value into a field, also one behind a disclosure, and presses Enter. */
  async enter(field: string, value: string): Promise<void> {
    await this.page.$eval(field, (one) => {
      for (let at = one.closest("details"); at != null; at = at.parentElement?.closest("details") ?? null)
        at.open = true;
      (one as HTMLInputElement).focus();
      (one as HTMLInputElement).select();
    });
    await this.page.keyboard.type(value);
    await this.page.keyboard.press("Enter");
  }

  /** Drops files on the page. */
  async drop(dropped: Files): Promise<void> {
    const encoded = Object.entries(dropped).map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]);
    await this.page.evaluate((parts) => {
      const dataTransfer = new DataTransfer();
      for (const [name = "", base64 = ""] of parts)
        dataTransfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    }, encoded);
  }

  /** Clicks a button that saves a file, and returns its text instead. */
  async saved(button: string): Promise<string> {
    await this.page.evaluate(() => {
      Object.assign(globalThis, { saved: undefined });
      HTMLAnchorElement.prototype.click = function () {
        const text = fetch(this.href).then((file) => file.text());
        text.then((saved) => Object.assign(globalThis, { saved }));
      };
    });
    await this.press(button);
    await this.page.waitForFunction("globalThis.saved !== undefined", PATIENCE);
    return (await this.page.evaluate("globalThis.saved")) as string;
  }

  /** Waits until the browser has kept everything. */
  async kept(): Promise<void> {
    await this.page.waitForFunction(() => dispatchEvent(new Event("beforeunload", { cancelable: true })), PATIENCE);
  }

  async reload(): Promise<void> {
    await this.page.reload();
  }

  /** Another tab of the same browser, which shares what is kept. */
  async tab(): Promise<FirefoxPage> {
    // Firefox 140 does not tell Puppeteer that the page has changed its address.
    const address = await this.page.evaluate(() => location.href);
    const { page, errors } = await FirefoxTest.tab(this.page.browserContext(), address);
    return new FirefoxPage(page, errors);
  }
}

/** How a test opens the page. */
interface Visit {
  address?: string;
  /** Runs in the page before its own scripts. */
  script?: () => void;
}

type Work = (opened: FirefoxPage, firefox: FirefoxTest) => Promise<void>;

/** Tests of the page in Firefox. Each opens it in a context of its own, with a sample that is aligned. */
export function firefoxTests() {
  let started: Promise<FirefoxTest> | undefined;
  after(async () => (await started)?.stop());
  return (title: string, ...parameters: [Work] | [Visit, Work]) => {
    const [{ address = "#sample=mug", script }, work] = parameters.length === 1 ? [{}, ...parameters] : parameters;
    test(title, { skip: skipFirefox }, async () => {
      started ??= FirefoxTest.start(siteDir);
      const firefox = await started;
      const { page, errors } = await firefox.open(`index.html${address}`, script);
      const opened = new FirefoxPage(page, errors);
      await opened.aligned();
      await work(opened, firefox);
      assert.deepEqual(errors, []);
      await page.browserContext().close();
    });
  };
}
