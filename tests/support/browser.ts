/** A browser, a static server for its pages, and checks of accessibility by axe. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after } from "node:test";
import { pathToFileURL } from "node:url";
import { type Browser, type BrowserContextOptions, chromium, type Page } from "playwright-core";
import { repository } from "./environment.js";

/** A running server. */
export interface Server {
  url: string;
  close(): Promise<void>;
}

/** Serves a folder. */
export const serve = async (folder: string): Promise<Server> =>
  (await import(pathToFileURL(join(repository, "scripts", "lib", "static-server.mjs")).href)).serve(folder);

const flags = [
  "--no-sandbox",
  "--enable-unsafe-webgpu",
  "--disable-background-networking",
  "--disable-component-update",
  // In software rendering, a long frame does not mean that the graphics card hangs.
  "--disable-gpu-watchdog",
  "--disable-quic",
  "--disable-sync",
  "--no-first-run",
];

/** Software rendering with WebGL 2. */
export const SOFTWARE = [
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--ignore-gpu-blocklist",
  "--enable-gpu",
];

/** Software rendering with WebGPU and WebGL 2. */
export const SOFTWARE_WEBGPU = [...SOFTWARE, "--enable-features=Vulkan", "--use-vulkan=swiftshader"];

/** Time limit for anything that a busy machine may be slow at. */
export const PATIENCE = { timeout: 120_000 };

/** Chromium without WebGPU: the 3D view draws with WebGL 2. */
export const WEBGL = ["!--enable-unsafe-webgpu"];
/** Chromium without graphics, for tests of other parts than the 3D view: drawing it in software takes most of their time. */
export const WITHOUT_3D = [...WEBGL, "--disable-3d-apis"];

/** A browser and a server of a folder, which start with the first page. */
export class PageTest {
  private started: Promise<{ browser: Browser; server: Server }> | undefined;

  /**
   * @param folder the served folder, by default the repository
   * @param more flags of Chromium; a "!" removes a default flag
   */
  constructor(
    private readonly folder = repository,
    private readonly more: readonly string[] = [],
  ) {}

  private async start() {
    const executablePath = process.env.CHROMIUM_PATH;
    if (executablePath === undefined) throw new Error('CHROMIUM_PATH is not set: run the tests by "npm test".');
    const { folder, more } = this;
    const args = [
      ...flags.filter((flag) => !more.includes(`!${flag}`)),
      ...more.filter((flag) => !flag.startsWith("!")),
    ];
    // The browser first, because it may fail to launch, and a running server would keep the process alive.
    const browser = await chromium.launch({ executablePath, headless: !process.env.SIM3ALIGN_WINDOW, args });
    return { browser, server: await serve(folder) };
  }

  /**
   * Opens a page.
   * @param path its path in the folder, such as `www/index.html`, or a URL
   * @param context settings of the browser context, such as window size and colour scheme
   * @param script runs in the page before its own scripts
   * @returns the page and its errors, a list that grows
   */
  async open(
    path: string,
    context: BrowserContextOptions = {},
    script?: () => void,
  ): Promise<{ page: Page; errors: string[] }> {
    this.started ??= this.start();
    const { browser, server } = await this.started;
    const page = await browser.newPage(context);
    page.setDefaultTimeout(PATIENCE.timeout);
    if (script !== undefined) await page.addInitScript(script);
    const errors: string[] = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => {
      if (message.type() === "error") errors.push(message.text());
    });
    await page.goto(new URL(path, server.url).href);
    return { page, errors };
  }

  /** Stops both. */
  async stop(): Promise<void> {
    const running = await this.started?.catch(() => undefined);
    await running?.browser.close();
    await running?.server.close();
  }
}

/** A browser and a server for all tests of a file. */
export function browserFor(...parameters: ConstructorParameters<typeof PageTest>): PageTest {
  const made = new PageTest(...parameters);
  after(() => made.stop());
  return made;
}

/** The violations that axe finds on a page, one line per rule. */
export async function violations(page: Page): Promise<string[]> {
  await page.evaluate(readFileSync(join(repository, "node_modules", "axe-core", "axe.min.js"), "utf8"));
  const run = `axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] })`;
  const found = (await page.evaluate(run)) as { violations: { id: string; nodes: { html: string }[] }[] };
  return found.violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(" | ")}`);
}
