/** The page in Firefox: it aligns, and nobody's work is lost. */
import assert from "node:assert/strict";
import type { FirefoxTest } from "../support/firefox.js";
import { FirefoxPage, firefoxTests } from "../support/firefox-page.js";
import { farther, four, zipped } from "../support/page-cases.js";
import { files, inFolder } from "../support/page-files.js";
import { installWorkerGate, siteDir } from "../support/site.js";
import { serve } from "../support/static-server.js";

const test = firefoxTests();

const isAccepted = (opened: FirefoxPage) => opened.has("#accept", /Accepted/);

test("the page aligns its sample in Firefox, and poses are changed, undone and accepted", async (opened) => {
  await opened.has("#confidence", /9\d % · Likely correct/);
  const size = await opened.dimensions();
  assert.ok(size.length === 3 && size.every((side) => side > 8 && side < 14), `the mug is ${size} cm`);
  await opened.press("Move left");
  await opened.isNow("hand");
  await opened.click("#undo");
  await opened.isNow("aligned");
  await opened.click("#accept");
  await isAccepted(opened);
  // The image shows the silhouette: not all of it is grey.
  const isColoured = await opened.page.evaluate(() => {
    const canvas = document.querySelector(".image canvas") as HTMLCanvasElement;
    const { data } = (canvas.getContext("2d") as CanvasRenderingContext2D).getImageData(
      0,
      0,
      canvas.width,
      canvas.height,
    );
    return data.some((value, i) => i % 4 === 0 && Math.abs(value - (data[i + 2] ?? 0)) > 40);
  });
  assert.ok(isColoured);
  // Without WebGL, as on machines without graphics, the page says so, and results are in the image.
  await opened.has('.space:not([data-state="loading"])');
});

test("a photo alone is shown in Firefox, and its object marked", async (opened) => {
  await opened.page.evaluate(async () => {
    const canvas = new OffscreenCanvas(160, 120);
    const context = canvas.getContext("2d") as OffscreenCanvasRenderingContext2D;
    for (const [colour, left, top, width, height] of [
      ["#4a5a78", 0, 0, 160, 120],
      ["#e08030", 50, 40, 60, 40],
    ] as const) {
      context.fillStyle = colour;
      context.fillRect(left, top, width, height);
    }
    const transfer = new DataTransfer();
    transfer.items.add(new File([await canvas.convertToBlob()], "photo.png"));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true }));
  });
  await opened.click("#mark-mask");
  await opened.click("#mask-here");
  // A rectangle of 60 × 40 in 160 × 120 pixels.
  await opened.has("#mask-status", /^1[234] % of/);
  await opened.click("#mask-done");
  await opened.has(".pair canvas");
});

test("in Firefox, two tabs keep their scenes apart", async (opened) => {
  await opened.drop(files);
  await opened.shows("Own files");
  await opened.kept();
  const other = await opened.tab();
  await other.aligned();
  await other.has("#other-tabs", /Another tab has Own files open/);
  await other.drop(zipped(inFolder("second", farther(0.2))));
  await other.shows("second");
  await other.click("#accept");
  await other.kept();
  // The first tab works on, then both are loaded again.
  await opened.press("Move left");
  await opened.click("#accept");
  await opened.kept();
  const tabs = [opened, other];
  const centreOf = async (one: FirefoxPage) => {
    await one.has("#centre");
    return one.text("#centre");
  };
  const centres = await Promise.all(tabs.map(centreOf));
  await other.reload();
  await other.isShown("second");
  await opened.reload();
  await opened.isShown("Own files");
  await opened.isNow("hand");
  for (const [i, one] of tabs.entries()) {
    await isAccepted(one);
    assert.equal(await centreOf(one), centres[i]);
    assert.ok((await one.metric("iou")) > 0.7);
  }
  assert.deepEqual(other.errors, []);
});

test("in Firefox, a second tab takes over what the first one has open, as it was left", async (opened) => {
  await opened.drop(files);
  await opened.shows("Own files");
  await opened.click("#accept");
  await opened.kept();
  const other = await opened.tab();
  await other.press("Take over");
  await other.isShown("Own files");
  await isAccepted(other);
  // It is closed in the first tab.
  await opened.has("#other-tabs");
  await opened.hasNo('main[data-scene="Own files"]');
  assert.deepEqual(other.errors, []);
});

const gated = { address: "#sample=desk", script: installWorkerGate };
test("in Firefox, what is chosen while an alignment runs is aligned", gated, async (opened) => {
  const gate = (name: "open" | "close") => opened.page.evaluate(`workerGate.${name}()`);
  await gate("close");
  await opened.press("Align all 3");
  await opened.has("#cancel");
  await opened.drop(files);
  await opened.isShown("Own files");
  await gate("open");
  await opened.shows("Own files");
  await opened.isNow("aligned");
  await gate("close");
  await opened.click("#align");
  await opened.has("#cancel");
  await opened.click('[data-sample="hammer"]');
  await opened.isShown("Hammer");
  await gate("open");
  await opened.shows("Hammer");
  await opened.isNow("aligned");
});

test("in Firefox, the work on all scenes of a drop is kept, saved and restored", async (opened) => {
  await opened.drop(zipped(four));
  await opened.sheet();
  await opened.click("#intake-open");
  for (const scene of ["IMG_001", "IMG_002"]) {
    await opened.shows(scene);
    await opened.click("#accept");
    await opened.click("#next");
  }
  await opened.shows("IMG_003");
  const states = async () => (await opened.texts(".scenes li")).map((text) => text.replace(/^IMG_00\d /, ""));
  assert.deepEqual(await states(), ["✓ accepted", "✓ accepted", "aligned", "to do"]);
  type Result = Record<string, { decidedBy: string }>;
  const all = JSON.parse(await opened.saved("JSON of all scenes")) as Record<string, Result | null>;
  const decided = Object.entries(all).map(([name, scene]) => [name, Object.values(scene ?? {})[0]?.decidedBy]);
  assert.deepEqual(decided, [
    ["IMG_001", "accepted"],
    ["IMG_002", "accepted"],
    ["IMG_003", "search"],
    ["IMG_004", undefined],
  ]);
  await opened.kept();
  await opened.reload();
  await opened.isShown("IMG_003");
  assert.deepEqual(await states(), ["✓ accepted", "✓ accepted", "aligned", "to do"]);
  await opened.click(".scenes li button");
  await opened.isShown("IMG_001");
  await isAccepted(opened);
});

/** The page from a server of its own, which goes away once the page is as wanted. */
async function withoutServer(firefox: FirefoxTest, isReady: (page: FirefoxPage) => Promise<void>, script?: () => void) {
  const server = await serve(siteDir);
  try {
    const { page, errors } = await firefox.open(`${server.url}index.html#sample=mug`, script);
    const opened = new FirefoxPage(page, errors);
    await opened.aligned();
    await isReady(opened);
    return opened;
  } finally {
    await server.close();
  }
}

test("in Firefox, the page, its samples and own files work without its server, once it is stored", async (_, firefox) => {
  const opened = await withoutServer(firefox, (page) => page.has("#privacy", /Works offline/));
  await opened.drop(files);
  await opened.shows("Own files");
  await opened.kept();
  await opened.reload();
  await opened.isShown("Own files");
  await opened.click('[data-sample="hammer"]');
  await opened.shows("Hammer");
});

const unstored = () => Object.defineProperty(navigator, "serviceWorker", { value: undefined });

test("in Firefox, a connection that is lost after loading is said, and nothing hangs", async (_, firefox) => {
  const opened = await withoutServer(firefox, async () => {}, unstored);
  await opened.drop(files);
  await opened.says(/^(?!Reading)/);
});
