/** The same journey in every browser: the package's bits, the element from another origin, the page with own files. */
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import type { Browser } from "puppeteer-core";
import { createAligner } from "sim3align";
import { work } from "../bundlers/work.js";
import { type Server, serve } from "../support/browser.js";
import { browserNames, launch, skipped, Tab } from "../support/driver.js";
import { elementFolder, installDir, servedFolder } from "../support/environment.js";
import { files } from "../support/page-files.js";
import { input } from "../support/scene.js";
import { PATIENCE } from "../support/site.js";

/** In Node. */
const expected = await work(createAligner);
const direct = await (await createAligner()).align(input);

for (const name of browserNames) {
  describe(name, { skip: skipped(name) }, () => {
    let browser: Browser;
    let server: Server;
    before(async () => {
      browser = await launch(name);
      server = await serve(servedFolder);
    });
    after(async () => {
      await browser?.close();
      await server?.close();
    });

    /** A tab in a context of its own. */
    const open = async (path: string) => Tab.open(await browser.createBrowserContext(), new URL(path, server.url).href);

    test("the package has the bits of Node, in both entries, with and without workers", async () => {
      const { page, errors } = await open(`${elementFolder}/frame.html`);
      for (const entry of ["index", "inline"]) {
        const found = (await page.evaluate(`(async () => {
          const { createAligner } = await import("/install-test/node_modules/sim3align/${entry}.js");
          const { work } = await import("/install-test/tests/bundlers/work.js");
          const wasm = { joint: "/install-test/node_modules/sim3align/wasm/joint_bg.wasm" };
          return JSON.stringify(await work((options) => createAligner({ ...options, wasm })));
        })()`)) as string;
        assert.deepEqual(JSON.parse(found), expected, entry);
      }
      assert.deepEqual(errors, []);
    });

    test("one script tag loads the element from another origin; it aligns arrays to the bits of Node", async (t) => {
      const { url, close } = await serve(servedFolder);
      t.after(close);
      const script = `<script type="module" src="${url}${elementFolder}/sim3-align.js"></script>`;
      const path = `host-${new URL(url).port}.html`;
      writeFileSync(
        join(installDir, path),
        `<!doctype html><link rel="icon" href="data:,">${script}<sim3-align id="a"></sim3-align>`,
      );
      const { page, errors } = await open(`install-test/${path}`);
      const found = await page.evaluate(`(async () => {
        const { mask, mesh, ...view } = (await import("/install-test/tests/support/scene.js")).input;
        const element = document.querySelector("sim3-align");
        const aligned = new Promise((resolve) => element.addEventListener("align", ({ detail }) => resolve(detail)));
        element.scene = { ...view, objects: [{ mask, mesh }] };
        return (await aligned).objects[0].pose.matrix;
      })()`);
      assert.deepEqual(found, [...direct.matrix]);
      const area = await page.evaluate(() => {
        const panel = document.querySelector("sim3-align")?.shadowRoot?.querySelector(".result");
        return (panel?.clientWidth ?? 0) * (panel?.clientHeight ?? 0);
      });
      assert.ok(area > 20_000, "the sheets of the element apply");
      assert.deepEqual(errors, []);
    });

    test("own files are aligned, moved, undone and accepted, kept over a reload, and taken over by a tab", async () => {
      const tab = await open("www/index.html#sample=mug");
      await tab.aligned();
      await tab.drop(files);
      await tab.has('main[data-scene="Own files"]');
      assert.ok((await tab.aligned()) > 0.9);
      const confidence = await tab.text(".badge");
      await tab.press("Move left");
      await tab.has(".badge", /^Moved by hand$/);
      await tab.click("#undo");
      await tab.has('.result[data-source="aligned"]');
      assert.equal(await tab.text(".badge"), confidence);
      await tab.press("Move right");
      await tab.click("#accept");
      const centre = await tab.text("#centre");
      await tab.kept();
      await tab.page.reload();
      const isAsLeft = async (one: Tab) => {
        await one.has('main[data-scene="Own files"]');
        await one.has("#accept", /Accepted/);
        // In a panel that is loaded later.
        await one.has("#centre");
        assert.equal(await one.text("#centre"), centre);
      };
      await isAsLeft(tab);
      // Firefox 140 does not tell Puppeteer that the page has changed its address.
      const address = await tab.page.evaluate(() => location.href);
      const other = await Tab.open(tab.page.browserContext(), address);
      await other.press("Take over");
      await isAsLeft(other);
      await tab.page.waitForSelector("#other-tabs", PATIENCE);
      assert.deepEqual([tab.errors, other.errors], [[], []]);
    });
  });
}
