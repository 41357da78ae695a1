/** The custom element `<sim3-align>`, its page for iframes, and scenes by address. */
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { zipSync } from "fflate";
import type { Page } from "playwright-core";
import { type AlignInput, createAligner } from "sim3align";
import { browserFor, serve, WEBGL } from "../support/browser.js";
import { elementFolder, installDir, servedFolder } from "../support/environment.js";
import { type Files, files, inFolder, jsonFile, seen } from "../support/page-files.js";
import { mesh, pinhole, truth } from "../support/scene.js";
import { PATIENCE } from "../support/site.js";

/** The element as a host's script sees it. */
interface Element extends HTMLElement {
  pose: { scale: number; matrix: number[]; translation: number[] } | null;
  options: Record<string, unknown>;
  readonly: boolean;
  session: object;
  results: { name: string; confidence: number | null; isAccepted: boolean; sizeM: number[] | null }[];
}

/** Globals of the tests in the page. */
declare global {
  interface Window {
    told: { of: string; type: string; detail: Record<string, unknown> }[];
    arrays: object;
  }
}

const browser = browserFor(servedFolder, WEBGL);

/** Leaves the scene in the page, as arrays. */
async function giveArrays(page: Page): Promise<void> {
  const { mask, ...view } = seen;
  await page.evaluate((scene) => void Object.assign(window, { arrays: scene }), {
    ...view,
    name: "Blob",
    objects: [{ name: "blob", mask, mesh }],
  });
}

/** Sets properties of an element of the page, and its scene to that of `giveArrays`. */
const give = (page: Page, id: string, properties: object = {}) =>
  page.evaluate(
    ([id, given]) => void Object.assign(document.querySelector(`#${id}`) as Element, given, { scene: window.arrays }),
    [id, properties] as const,
  );

/** A page of a host, with the script of the element and a record of all events. */
async function host(html: string, script = "sim3-align"): Promise<{ page: Page; errors: string[] }> {
  const opened = await browser.open(`${elementFolder}/frame.html`);
  const { page } = opened;
  // Without the script of that page.
  await page.route("**/host.html", (route) => route.fulfill({ contentType: "text/html", body: html }));
  await page.goto(new URL("/host.html", page.url()).href);
  await giveArrays(page);
  await page.evaluate(() => {
    window.told = [];
    for (const element of document.querySelectorAll<HTMLElement>("sim3-align")) {
      for (const type of ["ready", "progress", "align", "posechange", "accept", "error"]) {
        element.addEventListener(type, (event) =>
          window.told.push({ of: element.id, type, detail: (event as CustomEvent).detail }),
        );
      }
    }
  });
  await page.evaluate(`import("/${elementFolder}/${script}.js")`);
  return opened;
}

/** Waits until an element has told of an event, and returns its detail. */
async function told<T>(page: Page, of: string, type: string): Promise<T> {
  const found = await page.waitForFunction(
    ([id, name]) => window.told.find((one) => one.of === id && one.type === name)?.detail,
    [of, type] as const,
    PATIENCE,
  );
  return (await found.jsonValue()) as T;
}

/** The files of the scene, at an address. */
async function serveFiles(page: Page, path: string, served: Files): Promise<void> {
  const isServed = (url: URL) => url.pathname.startsWith(`/${path}/`);
  await page.route(isServed, (route) => {
    const body = served[new URL(route.request().url()).pathname.slice(path.length + 2)];
    return body === undefined ? route.fulfill({ status: 404 }) : route.fulfill({ body: Buffer.from(body) });
  });
}

test("instances on one page are independent, and report what they do", async () => {
  const { page, errors } = await host(`<sim3-align id="a"></sim3-align><sim3-align id="b" manual></sim3-align>`);
  await give(page, "a");
  await give(page, "b", { options: { quality: "fast", seed: 7 } });
  await told(page, "a", "align");
  await told(page, "b", "ready");
  const events = await page.evaluate(() => window.told.filter(({ of }) => of === "a").map(({ type }) => type));
  assert.equal(events[0], "ready");
  assert.ok(events.includes("progress") && !events.includes("error"), `${events}`);
  assert.equal(events.filter((type) => type === "posechange").length, 1);
  // The element has no effect on the page around it.
  assert.equal(await page.evaluate(() => document.documentElement.style.colorScheme), "");
  const states = () =>
    page.evaluate(() =>
      ["a", "b"].map((id) => {
        const element = document.querySelector(`#${id}`) as Element;
        const root = element.shadowRoot as ShadowRoot;
        const undo = root.querySelector("#undo")?.getAttribute("aria-disabled");
        return {
          source: root.querySelector(".result")?.getAttribute("data-source"),
          options: [element.options.quality, element.options.seed],
          isAccepted: element.results[0]?.isAccepted,
          sides: element.results[0]?.sizeM?.length ?? 0,
          undo,
        };
      }),
    );
  await page.locator("#a #accept").click();
  await told(page, "a", "accept");
  assert.deepEqual(await states(), [
    { source: "aligned", options: ["auto", 0], isAccepted: true, sides: 3, undo: "false" },
    { source: "start", options: ["fast", 7], isAccepted: false, sides: 0, undo: "true" },
  ]);
  // The other way round: undoing in one leaves the other.
  await page.locator("#b #align").click();
  await told(page, "b", "align");
  await page.locator("#b #undo").click();
  assert.deepEqual(
    (await states()).map(({ source }) => source),
    ["aligned", "start"],
  );
  assert.deepEqual(errors, []);
  await page.close();
});

test("the element in one script, which is that of its workers, loads that and three.js", async () => {
  const { page, errors } = await host(`<sim3-align id="a"></sim3-align>`, "single");
  await give(page, "a");
  await told(page, "a", "align");
  await page.waitForFunction(() =>
    performance.getEntriesByType("resource").some(({ name }) => name.endsWith("/three.js")),
  );
  const scripts = await page.evaluate(() =>
    performance.getEntriesByType("resource").flatMap(({ name }) => /\/element\/([^/]*)\.js$/.exec(name)?.[1] ?? []),
  );
  // three.js imports one of the parts. The script is listed again when a worker has started with it.
  const names = [...new Set(scripts)].sort();
  assert.deepEqual(names.slice(-2), ["single", "three"]);
  assert.ok(names.length <= 3, `${names}`);
  const workers = page.workers().filter((worker) => worker.url().endsWith("/element/single.js"));
  assert.ok(workers.length > 0);
  assert.deepEqual(errors, []);
  await page.close();
});

test("pose and session are set and read, and survive a transfer as JSON", async () => {
  const { page } = await host(`<sim3-align id="a"></sim3-align><sim3-align id="b"></sim3-align>`);
  const pose = { scale: 0.1, rotation: [1, 0, 0, 0], translation: [0.01, 0.02, 0.7] };
  const isSet = await page.evaluate((pose) => {
    const element = document.querySelector("#a") as Element;
    // Before the scene is there; with a pose, nothing is aligned.
    Object.assign(element, { pose, scene: window.arrays });
    return element.pose;
  }, pose);
  assert.equal(isSet, null);
  await told(page, "a", "posechange");
  await page.locator("#a #accept").click();
  await told(page, "a", "accept");
  const session = await page.evaluate(() => JSON.stringify((document.querySelector("#a") as Element).session));
  await give(page, "b", { session: JSON.parse(session) });
  await told(page, "b", "ready");
  const restored = await page.evaluate(() => {
    const { pose, results, session } = document.querySelector("#b") as Element;
    return { pose, isAccepted: results[0]?.isAccepted, session: JSON.stringify(session) };
  });
  assert.equal(restored.pose?.scale, pose.scale);
  assert.deepEqual(restored.pose?.translation, pose.translation);
  assert.equal(restored.isAccepted, true);
  assert.equal(restored.session, session);
  const types = await page.evaluate(() => window.told.map(({ type }) => type));
  assert.ok(!types.includes("align"));
  await page.close();
});

test("depth in integers is read as align() reads it, and what is set beside the next scene is for it", async () => {
  const { page } = await host(`<sim3-align id="a"></sim3-align>`);
  const { depth, mask, width, height } = seen;
  const along = depth.map((z, i) => {
    const [x, y] = [((i % width) - pinhole.cx) / pinhole.fx, (Math.floor(i / width) - pinhole.cy) / pinhole.fy];
    return z * Math.hypot(x, y, 1);
  });
  const views = [
    { depth: Uint16Array.from(along, (m) => Math.round(1000 * m)), depthKind: "ray-distance", camera: pinhole },
    { depth: Uint16Array.from(depth, (z) => Math.round(5000 * z)), camera: { ...pinhole, depthScale: 0.0002 } },
  ] as const;
  using aligner = await createAligner({ workers: 0 });
  for (const view of views) {
    const sized = { ...view, width, height };
    const expected = await aligner.align({ ...sized, mask, mesh } as AlignInput);
    const found = await page.evaluate(
      (scene) => {
        const element = document.querySelector("#a") as Element;
        const aligned = new Promise((resolve) => element.addEventListener("align", resolve, { once: true }));
        Object.assign(element, { scene });
        return aligned.then(() => element.pose);
      },
      { ...sized, objects: [{ mask, mesh }] },
    );
    assert.ok(Math.abs((found?.scale ?? 0) / expected.scale - 1) < 1e-4, `${found?.scale}, ${expected.scale}`);
  }
  // At once after the next scene, which takes time to read.
  const state = await page.evaluate((pose) => {
    const element = document.querySelector("#a") as Element;
    Object.assign(element, { scene: window.arrays });
    Object.assign(element, { pose });
    return [element.pose, element.results.length];
  }, truth);
  assert.deepEqual(state, [null, 0]);
  await page.waitForFunction(() => (document.querySelector("#a") as Element).pose !== null, null, PATIENCE);
  assert.equal(await page.evaluate(() => (document.querySelector("#a") as Element).pose?.scale), truth.scale);
  await page.evaluate(() => void Object.assign(document.querySelector("#a") as Element, { scene: null }));
  assert.equal(await page.evaluate(() => (document.querySelector("#a") as Element).results.length), 0);
  assert.equal(await page.locator("#a #status").textContent(), "No scene.");
  await page.close();
});

test("read-only, nothing can be changed, and tokens and parts style the element", async () => {
  const style = `<style>sim3-align { --accent: rgb(1 2 3); } sim3-align::part(result) { outline: 3px solid red; }</style>`;
  const { page } = await host(`${style}<sim3-align id="a" readonly></sim3-align>`);
  // It is not aligned.
  await give(page, "a", { pose: truth });
  await told(page, "a", "posechange");
  assert.equal(await page.locator("#a :is(#align, #accept, #refine, .hand-panel)").count(), 0);
  const state = () =>
    page.evaluate(() => {
      const { pose, results } = document.querySelector("#a") as Element;
      return JSON.stringify([pose, results[0]?.isAccepted]);
    });
  const before = await state();
  const press = async () => {
    // The canvas of the image takes no focus.
    await page.locator("#a .space[data-state=ready] canvas").first().focus(PATIENCE);
    for (const key of ["g", "ArrowLeft", "PageUp", "l", "Control+Enter"]) await page.keyboard.press(key);
  };
  await press();
  assert.equal(await state(), before);
  const outline = await page.locator("#a .result").evaluate((panel) => getComputedStyle(panel).outlineWidth);
  assert.equal(outline, "3px");
  assert.equal(
    await page.locator("#a .result").evaluate((panel) => getComputedStyle(panel).getPropertyValue("--accent")),
    "rgb(1 2 3)",
  );
  await page.evaluate(() => {
    (document.querySelector("#a") as Element).readonly = false;
  });
  await page.locator("#a #align").waitFor(PATIENCE);
  await press();
  await told(page, "a", "accept");
  assert.notEqual(await state(), before);
  await page.close();
});

test("what is missing or wrong in a scene in memory is an error with its code", async () => {
  const { page } = await host(`<sim3-align id="a" manual></sim3-align>`);
  const { mask, ...view } = seen;
  for (const [objects, found] of [
    [undefined, ["INVALID_ARGUMENT", /^objects: /]],
    [[{ mask }], ["INVALID_ARGUMENT", /^mesh: /]],
    [[{ mesh }], ["INVALID_ARGUMENT", /^objects\[0\]\.mask: /]],
    [[{ mask: mask.slice(1), mesh }], ["WRONG_LENGTH", /^objects\[0\]\.mask: /]],
  ] as const) {
    const { code, message } = await page.evaluate(
      (scene) => {
        const element = document.querySelector("#a") as Element;
        const failed = new Promise<Event>((resolve) => element.addEventListener("error", resolve, { once: true }));
        Object.assign(element, { scene });
        return failed.then((event) => (event as CustomEvent<{ code: string; message: string }>).detail);
      },
      { ...view, objects },
    );
    assert.equal(code, found[0], message);
    assert.match(message, found[1]);
  }
  await page.close();
});

test("a start pose is no result: it has no size and, read-only, no mesh is shown", async () => {
  const { page } = await host(`<sim3-align id="a" readonly></sim3-align><sim3-align id="b" manual></sim3-align>`);
  for (const id of ["a", "b"]) {
    await give(page, id);
    const label = page.locator(`#${id} .space[data-state=ready] canvas`).first();
    await label.waitFor(PATIENCE);
    await page.locator(`#${id} .space canvas[aria-label$="no mesh placed yet"]`).first().waitFor(PATIENCE);
  }
  assert.match((await page.locator("#a [role=status]").textContent()) ?? "", /No pose is set/);
  const imageOf = (id: string) =>
    page.locator(`#${id} .image canvas`).evaluate((canvas) => (canvas as HTMLCanvasElement).toDataURL());
  assert.notEqual(await imageOf("a"), await imageOf("b"), "the start pose is drawn where it can be changed");
  await page.evaluate((pose) => void Object.assign(document.querySelector("#a") as Element, { pose }), truth);
  await page.locator('#a .space canvas[aria-label$="placed meshes: blob"]').first().waitFor(PATIENCE);
  assert.equal(await page.locator("#a [role=status]").textContent(), "");
  await page.close();
});

test("src names a zip archive, a session or an index, and what cannot be opened is an error event", async () => {
  const { page } = await host(
    ["zip", "index", "bad", "gone"].map((id) => `<sim3-align id="${id}" manual></sim3-align>`).join(""),
  );
  await serveFiles(page, "cases", {
    ...files,
    "case.zip": zipSync(inFolder("mug", files)),
    "index.json": jsonFile({ files: Object.keys(files) }),
    "bad.txt": Buffer.from("no case"),
  });
  const sources = { zip: "case.zip", index: "index.json", bad: "bad.txt", gone: "gone.zip" };
  await page.evaluate((sources) => {
    for (const [id, name] of Object.entries(sources))
      document.querySelector(`#${id}`)?.setAttribute("src", `/cases/${name}`);
  }, sources);
  for (const [id, opened] of Object.entries({ zip: "mug", index: "cases" })) {
    assert.equal((await told<{ name: string }>(page, id, "ready")).name, opened);
  }
  for (const [id, says] of Object.entries({
    bad: /neither a zip archive nor an index/,
    gone: /http:.*\/cases\/gone\.zip could not be loaded: HTTP 404/,
  })) {
    assert.match((await told<{ message: string }>(page, id, "error")).message, says);
    // To its end, in a narrow element too.
    const status = page.locator(`#${id} #status`);
    assert.match((await status.textContent()) ?? "", says);
    assert.ok(await status.evaluate((line) => line.scrollHeight <= line.clientHeight), id);
  }
  await page.close();
});

test("an iframe is controlled by messages of its parent's origin, and of no other", async () => {
  const other = await serve(servedFolder);
  const { page } = await browser.open(`${elementFolder}/frame.html?readonly`);
  const own = new URL(page.url()).origin;
  // The page of the site of the frame, which names the parent.
  const html = readFileSync(join(servedFolder, elementFolder, "frame.html"), "utf8");
  const trusting = html
    .replace('content=""', `content="https://app.example ${own}"`)
    .replace("./frame.js", `/${elementFolder}/frame.js`);
  const name = `frame-${new URL(other.url).port}.html`;
  writeFileSync(join(installDir, name), trusting);
  try {
    const framed = async (path: string) => {
      await page.setContent("<iframe width=900 height=600></iframe>");
      await page.evaluate(
        ([url, path]) => {
          window.told = [];
          addEventListener("message", ({ data, origin }) =>
            window.told.push({ of: origin, type: data.type, detail: data }),
          );
          const frame = document.querySelector("iframe") as HTMLIFrameElement;
          frame.src = `${url}${path}`;
          return new Promise((resolve) => {
            frame.onload = resolve;
          });
        },
        [other.url, path] as const,
      );
    };
    const from = new URL(other.url).origin;
    await framed(`install-test/${name}`);
    await told(page, from, "sim3align:loaded");
    await giveArrays(page);
    await page.evaluate((origin) => {
      const { contentWindow } = document.querySelector("iframe") as HTMLIFrameElement;
      contentWindow?.postMessage({ type: "sim3align:load", scene: window.arrays }, origin);
    }, from);
    await told(page, from, "sim3align:align");
    await page.evaluate((origin) => {
      const { contentWindow } = document.querySelector("iframe") as HTMLIFrameElement;
      contentWindow?.postMessage({ type: "sim3align:get", id: 5 }, origin);
      contentWindow?.postMessage({ type: "sim3align:nonsense", id: 6 }, origin);
    }, from);
    const answer = await told<{ id: number; results: Element["results"] }>(page, from, "sim3align:results");
    assert.equal(answer.id, 5);
    assert.equal(answer.results[0]?.name, "blob");
    assert.ok((answer.results[0]?.confidence ?? 0) > 0.5);
    assert.equal((await told<{ id: number }>(page, from, "sim3align:error")).id, 6);
    // Where the site does not name it, its parent is told nothing and not listened to, whatever the address of the frame says.
    await framed(`${elementFolder}/frame.html?origin=${encodeURIComponent(own)}`);
    const frame = page.frames().find((one) => one.url().startsWith(other.url));
    await frame?.waitForSelector("sim3-align");
    const next = await frame?.evaluateHandle(() => ({
      came: new Promise((resolve) => addEventListener("message", resolve, { once: true })),
    }));
    await page.evaluate((origin) => {
      const { contentWindow } = document.querySelector("iframe") as HTMLIFrameElement;
      contentWindow?.postMessage({ type: "sim3align:load", readonly: true }, origin);
    }, from);
    await next?.evaluate(({ came }) => came.then(() => {}));
    assert.equal(await frame?.evaluate(() => document.querySelector("sim3-align")?.hasAttribute("readonly")), false);
    assert.deepEqual(await page.evaluate(() => window.told), []);
  } finally {
    await page.close();
    await other.close();
  }
});

test("?case= opens a scene on the page, and an address that fails says why", async () => {
  const { page } = await browser.open(`${elementFolder}/frame.html?readonly`);
  await serveFiles(page, "cases", { "case.zip": zipSync(inFolder("mug", files)) });
  const visit = (path: string) => page.goto(new URL(path, page.url()).href);
  await visit("/www/index.html?case=/cases/case.zip");
  await page.locator('main[data-scene="mug"]').waitFor(PATIENCE);
  await page.locator("#status:has-text('Aligned')").waitFor(PATIENCE);
  await visit("/www/index.html?case=/cases/none.zip");
  await page.locator("#status:has-text('HTTP 404')").waitFor(PATIENCE);
  await page.close();
});
