/** Firefox, driven by WebDriver BiDi, and a static server for its pages. */
import puppeteer, { type Browser, type Page } from "puppeteer-core";
import { type Server, serve } from "./static-server.js";

const executablePath = process.env.FIREFOX_PATH;

/** Why tests in Firefox are skipped; false if they run. */
export const skipFirefox: string | false = executablePath
  ? false
  : "No Firefox. Remedy: install it (Debian: apt-get install firefox-esr), or name it in FIREFOX_PATH.";

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

  /** Opens a page. Returns it and its errors, a list that grows. */
  async open(path: string): Promise<{ page: Page; errors: string[] }> {
    const page = await this.browser.newPage();
    await page.setViewport({ width: 1280, height: 800 });
    const errors: string[] = [];
    page.on("pageerror", (error) => errors.push(`${error}`));
    page.on("console", (message) => {
      if (message.type() === "error") errors.push(message.text());
    });
    await page.goto(new URL(path, this.server.url).href);
    return { page, errors };
  }

  async stop(): Promise<void> {
    await this.browser.close();
    await this.server.close();
  }
}
