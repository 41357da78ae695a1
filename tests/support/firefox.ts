/** Firefox, driven by WebDriver BiDi, and a static server for its pages. */
import puppeteer, { type Browser, type BrowserContext, type Page } from "puppeteer-core";
import { type Server, serve } from "./static-server.js";

const executablePath = process.env.FIREFOX_PATH;

/** Why tests in Firefox are skipped; false if they run. */
export const skipFirefox: string | false = executablePath
  ? false
  : "No Firefox. Remedy: install it (Debian: apt-get install firefox-esr), or name it in FIREFOX_PATH.";

/** A page and its errors, a list that grows. */
interface Opened {
  page: Page;
  errors: string[];
}

/** Sets the size of what a page sees. */
export async function setWindow(page: Page, width: number, height: number): Promise<void> {
  await page.setViewport({ width, height }).catch((error: unknown) => {
    // Puppeteer also sets the orientation of the screen, which Firefox 140 does not know.
    if (!`${error}`.includes("unknown command emulation.setScreenOrientationOverride")) throw error;
  });
  await page.waitForFunction((width) => innerWidth === width, {}, width);
}

/** Firefox and a server of a folder. */
export class FirefoxTest {
  private constructor(
    private readonly browser: Browser,
    private readonly server: Server,
  ) {}

  static async start(folder: string): Promise<FirefoxTest> {
    if (!executablePath) throw new Error(skipFirefox || "");
    // The browser first, because it may fail to launch, and a running server would keep the process alive.
    const browser = await puppeteer.launch({ browser: "firefox", executablePath, headless: true, timeout: 120_000 });
    return new FirefoxTest(browser, await serve(folder));
  }

  /**
   * Opens a page, which keeps its data for itself.
   * @param path its path in the folder, or a URL
   * @param script runs in the page before its own scripts
   */
  async open(path: string, script?: () => void): Promise<Opened> {
    const context = await this.browser.createBrowserContext();
    return FirefoxTest.tab(context, new URL(path, this.server.url).href, script);
  }

  /** Opens a page beside others, which share their data. */
  static async tab(context: BrowserContext, url: string, script?: () => void): Promise<Opened> {
    const page = await context.newPage();
    await setWindow(page, 1280, 800);
    if (script !== undefined) await page.evaluateOnNewDocument(script);
    const errors: string[] = [];
    page.on("pageerror", (error) => errors.push(`${error}`));
    page.on("console", (message) => {
      if (message.type() === "error") errors.push(message.text());
    });
    await page.goto(url);
    return { page, errors };
  }

  async stop(): Promise<void> {
    await this.browser.close();
    await this.server.close();
  }
}
