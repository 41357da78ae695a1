/** Zip archives that inflate to more than a tab can hold, dropped or at an address. */
import assert from "node:assert/strict";
import { drop, type Files, files, jsonFile } from "../support/page-files.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";
import { deflated, zeros, zip } from "../support/zip.js";

declare global {
  var turnsBefore: number[];
}

const test = pageTests();

const GB = 1 << 30;
const bomb = zeros("depth.npy", 3 * GB);
const entries = Object.entries(files).map(([path, content]) => deflated(path, content));

/** That the sheet refuses what was dropped, and the scene is still there. */
async function refuses(opened: SitePage, message: RegExp): Promise<void> {
  const { page } = opened;
  const problem = page.locator(".intake .error").filter({ hasText: message });
  await problem.waitFor(PATIENCE);
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  await page.click("#intake-cancel");
  await page.locator(".intake").waitFor({ state: "detached" });
}

test("a bomb is refused with what was found and what helps, and the scene stays", async (opened) => {
  await drop(opened, { "bomb.zip": zip([bomb]) });
  await refuses(opened, /Found 3\.2 GB of files with bomb\.zip; expected at most 1\.0 GB\. Unpack it/);
  await drop(opened, { "liar.zip": zip([...entries, { ...bomb, inflated: 5000 }]) });
  await refuses(opened, /Found depth\.npy in liar\.zip, which holds more than the 5000 bytes/);
  await drop(opened, { "outer.zip": zip([...entries, deflated("inner.zip", zip([bomb]))]) });
  await refuses(opened, /Found the archive inner\.zip in outer\.zip/);
  assert.deepEqual(opened.errors, []);
});

test("the page answers while an archive is inflated", async (opened, page) => {
  // How many tasks of a timer ran before each of the entries was inflated.
  await page.evaluate(() => {
    let turns = 0;
    setInterval(() => turns++);
    globalThis.turnsBefore = [];
    globalThis.DecompressionStream = class extends DecompressionStream {
      constructor(format: CompressionFormat) {
        super(format);
        globalThis.turnsBefore.push(turns);
      }
    };
  });
  await drop(opened, { "large.zip": zip([zeros("notes.txt", 200 << 20), ...entries]) });
  await opened.shows("Own files");
  const [atFirst = 0, atSecond = 0] = await page.evaluate(() => globalThis.turnsBefore);
  assert.ok(atSecond - atFirst >= 3, `${atSecond - atFirst} turns`);
});

test("?case= loads no more than a drop may hold", async (opened, page) => {
  const served: Files = {
    "bomb.zip": zip([bomb]),
    "many.json": jsonFile({ files: Array.from({ length: 10_001 }, (_, i) => `${i}.png`) }),
  };
  for (const [name, content] of Object.entries(served)) {
    const isIt = ({ pathname }: URL) => pathname === `/cases/${name}`;
    await page.route(isIt, (route) => route.fulfill({ body: Buffer.from(content) }));
  }
  await page.goto(new URL("?case=/cases/many.json", page.url()).href);
  await opened.says(/found 10001 files .*, expected at most 10000/);
  await page.goto(new URL("?case=/cases/bomb.zip", page.url()).href);
  await page.locator(".intake .error:has-text('Found 3.2 GB of files with bomb.zip')").waitFor(PATIENCE);
});
