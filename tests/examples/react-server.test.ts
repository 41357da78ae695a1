/** The example of React with workers and server rendering, built by Vite, in Chromium. */
import assert from "node:assert/strict";
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { join } from "node:path";
import { createInterface } from "node:readline";
import type { Readable } from "node:stream";
import { after, test } from "node:test";
import { createAligner } from "sim3align";
import { browserFor } from "../support/browser.js";
import { sampleDir } from "../support/environment.js";
import { examplesDir, filesOf, program } from "../support/examples.js";

const folder = join(examplesDir, "11-react-server");
const { skip } = program("CHROMIUM_PATH", "Chromium", "install it (Debian and Ubuntu: apt-get install chromium)");

declare global {
  interface Window {
    /** The number of workers that were ended. */
    ended: number;
  }
}

const vite = join(examplesDir, "node_modules", "vite", "bin", "vite.js");
const build = (...args: string[]) =>
  execFileSync(process.execPath, [vite, "build", "--logLevel", "warn", ...args], { cwd: folder });

const browser = browserFor(folder);
let server: ChildProcess | undefined;
after(async () => {
  server?.kill();
  if (server?.exitCode === null) await once(server, "exit");
});

test("11-react-server renders the result in Node, is hydrated, and aligns in workers until it goes", {
  skip,
}, async () => {
  build();
  build("--ssr", "entry-server.jsx", "--outDir", "dist/server");
  const env = { ...process.env, PORT: "0" };
  server = spawn(process.execPath, ["server.mjs"], { cwd: folder, env, stdio: ["ignore", "pipe", "inherit"] });
  const [url = ""] = await once(createInterface({ input: server.stdout as Readable }), "line");
  const expected = [...(await (await createAligner()).align(filesOf(sampleDir), { quality: "fast" })).matrix];
  const html = await (await fetch(url)).text();
  const [, shown = ""] = /<output id="first">([^<]*)<\/output>/.exec(html) ?? [];
  assert.deepEqual(JSON.parse(shown), expected);
  // What needs a browser has not begun.
  assert.match(html, /<p id="status" data-state="idle"><\/p>/);

  const { page, errors } = await browser.open(url, {}, () => {
    window.ended = 0;
    const { terminate } = Worker.prototype;
    Worker.prototype.terminate = function (this: Worker) {
      window.ended += 1;
      terminate.call(this);
    };
  });
  const result = async () => {
    await page.waitForSelector("#result", { timeout: 120_000 });
    return JSON.parse((await page.textContent("#result")) ?? "");
  };
  await page.click("#align");
  assert.deepEqual(await result(), expected);
  assert.deepEqual(JSON.parse((await page.textContent("#first")) ?? ""), expected);

  // Goes while it runs, in the moment in which it tells its first progress: the worker of an aborted call is ended.
  await page.click("#toggle");
  const ended = await page.evaluate(() => window.ended);
  await page.evaluate(() => {
    const toggle = document.querySelector("#toggle") as HTMLButtonElement;
    new MutationObserver((_, observer) => {
      if ((document.querySelector("progress")?.value ?? 0) === 0) return;
      observer.disconnect();
      toggle.click();
    }).observe(document, { subtree: true, childList: true, attributes: true });
    toggle.click();
  });
  await page.waitForFunction((before) => window.ended > before, ended);
  await page.waitForSelector("#status", { state: "detached" });

  // The next one runs to its end, with the same bits.
  await page.click("#toggle");
  assert.deepEqual(await result(), expected);
  // None of hydration, and none of a component that has gone.
  assert.deepEqual(errors, []);
});
