/** A browser that shows pages served from the repository. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { type Browser, type BrowserContextOptions, chromium, type Page } from "playwright-core";
import { repository } from "./environment.js";

const flags = [
  "--no-sandbox",
  "--enable-unsafe-webgpu",
  "--disable-background-networking",
  "--disable-component-update",
  // Where a processor draws, a long frame is no graphics card that hangs.
  "--disable-gpu-watchdog",
  "--disable-quic",
  "--disable-sync",
  "--no-first-run",
];

/** The processor draws, as WebGL 2 has it. */
export const SOFTWARE = [
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--ignore-gpu-blocklist",
  "--enable-gpu",
];

/** The processor draws, as WebGPU has it too. */
export const SOFTWARE_WEBGPU = [...SOFTWARE, "--enable-features=Vulkan", "--use-vulkan=swiftshader"];

interface Server {
  url: string;
  close(): Promise<void>;
}

/** A browser and a server of a folder: the repository's, where none is named. */
export class PageTest {
  private constructor(
    private readonly browser: Browser,
    private readonly server: Server,
  ) {}

  /**
   * Starts both.
   * @param folder what the server serves
   * @param more flags of Chromium; those that begin with "!" are taken away
   */
  static async start(folder = repository, more: readonly string[] = []): Promise<PageTest> {
    const executablePath = process.env.CHROMIUM_PATH;
    if (executablePath === undefined) throw new Error('CHROMIUM_PATH is not set: run the tests by "npm test".');
    const module = pathToFileURL(join(repository, "scripts", "lib", "static-server.mjs")).href;
    const { serve } = (await import(module)) as { serve(folder: string): Promise<Server> };
    const args = [
      ...flags.filter((flag) => !more.includes(`!${flag}`)),
      ...more.filter((flag) => !flag.startsWith("!")),
    ];
    // First what may fail: a server that nobody stops would keep the tests from ending.
    const browser = await chromium.launch({ executablePath, headless: true, args });
    return new PageTest(browser, await serve(folder));
  }

  /**
   * Opens a page of the repository.
   * @param path its path in the folder, such as `www/index.html`, or a whole address
   * @param context how the browser is: its window's size, its colours
   * @returns the page, and what it has logged as errors (a list that goes on growing)
   */
  async open(path: string, context: BrowserContextOptions = {}): Promise<{ page: Page; errors: string[] }> {
    const page = await this.browser.newPage(context);
    const errors: string[] = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => {
      if (message.type() === "error") errors.push(message.text());
    });
    await page.goto(new URL(path, this.server.url).href);
    return { page, errors };
  }

  /** Stops both. */
  async stop(): Promise<void> {
    await this.browser.close();
    await this.server.close();
  }
}
