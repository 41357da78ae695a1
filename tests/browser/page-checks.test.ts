/** Wrong inputs: each says at its own field what is wrong and what helps, and nothing runs meanwhile. */
import assert from "node:assert/strict";
import { resizeInput } from "sim3align/conventions";
import { maskPng as maskFile, png } from "../support/files.js";
import { otherCamera } from "../support/page-cases.js";
import {
  choose,
  depthNpy,
  drop,
  type Files,
  files,
  HEIGHT,
  jsonFile,
  maskPng,
  seen,
  WIDTH,
} from "../support/page-files.js";
import { pinhole } from "../support/scene.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

/** The problems that the sheet shows, by field. */
async function problems(opened: SitePage): Promise<Record<string, string>> {
  const sheet = await opened.sheet();
  const alerts = await sheet
    .locator("[role=alert]")
    .evaluateAll((all) => all.map(({ id, textContent }) => [id, textContent ?? ""]));
  return Object.fromEntries(alerts.map(([id = "", text]) => [id.replace(/-error(-\d+)?$/, ""), text ?? ""]));
}

const pixels = WIDTH * HEIGHT;

test("a rejected file leaves the scene, its files and its name as they were", async (opened, page) => {
  await drop(opened, files);
  await opened.shows("Own files");
  const dimensions = await opened.dimensions();
  await opened.click("#edit-files");
  await opened.sheet();
  await choose(opened, "mesh", "notes.glb", Buffer.from("no mesh"));
  assert.deepEqual(Object.keys(await problems(opened)), ["mesh"]);
  await page.keyboard.press("Escape");
  await page.locator(".intake").waitFor({ state: "detached" });
  assert.doesNotMatch((await page.textContent("#inputs")) ?? "", /notes\.glb/);
  // Keys do not run anything behind the sheet either.
  await opened.click("#edit-files");
  await opened.sheet();
  await choose(opened, "depth", "grey.png", png(new Uint8Array(pixels).fill(9), WIDTH, HEIGHT));
  assert.deepEqual(Object.keys(await problems(opened)), ["depth"]);
  assert.ok(await page.isDisabled("#intake-open"));
  await page.locator("#depth-file").press("a");
  assert.equal(await page.locator("#cancel").count(), 0);
  await page.keyboard.press("Escape");
  await page.click("#align");
  await opened.aligned();
  assert.deepEqual(await opened.dimensions(), dimensions);
  assert.match((await page.textContent("#inputs")) ?? "", /depth\.npy.*camera\.json/);
});

const wrong: readonly (readonly [title: string, changed: Files, field: string, says: RegExp])[] = [
  ["no reading at all", { "depth.npy": depthNpy(new Float32Array(pixels)) }, "depth", /no reading/],
  ["an empty mask", { "mask.png": maskPng(new Uint8Array(pixels)) }, "mask", /empty/],
  [
    "intrinsics of another image",
    { "camera.json": jsonFile({ ...pinhole, width: 640, height: 400 }) },
    "camera",
    /160 × 120/,
  ],
  [
    "a damaged mesh",
    { "mesh.obj": new Uint8Array(), "mesh.glb": Uint8Array.of(103, 108, 84, 70, 1) },
    "mesh",
    /expected/,
  ],
  ["a damaged photo", { "photo.jpg": Uint8Array.of(1, 2, 3) }, "photo", /cannot decode/],
];

test("a wrong file is an error of its field alone", async (opened, page, t) => {
  for (const [title, changed, field, says] of wrong) {
    await t.test(title, async () => {
      const dropped = Object.entries({ ...files, ...changed }).filter(([, bytes]) => bytes.length > 0);
      await drop(opened, Object.fromEntries(dropped));
      const found = await problems(opened);
      assert.deepEqual(Object.keys(found), [field], JSON.stringify(found));
      assert.match(found[field] ?? "", says);
      assert.doesNotMatch(found[field] ?? "", /cut short/);
      assert.ok(await page.isDisabled("#intake-open"));
      const ids = (await page.getAttribute(`#${field}-file`, "aria-describedby")) ?? "";
      assert.match(ids, new RegExp(`^${field}-error`));
      assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
      await page.click("#intake-cancel");
    });
  }
});

test("beside a depth map that cannot be read, mask and mesh are shown", async (opened, page) => {
  await drop(opened, { ...files, "depth.npy": Uint8Array.of(1, 2, 3) });
  assert.deepEqual(Object.keys(await problems(opened)), ["depth"]);
  for (const of of ["Mask of", "Mesh for"]) await page.locator(`.pair canvas[aria-label^="${of}"]`).waitFor(PATIENCE);
});

test("remedies are buttons", async (opened, page) => {
  const half = { width: WIDTH / 2, height: HEIGHT / 2 };
  const { data } = resizeInput({ mask: { data: seen.mask, width: WIDTH, height: HEIGHT } }, half).mask;
  await drop(opened, {
    ...files,
    "mask.png": maskFile(data, half.width, half.height),
    "photo.png": png(new Uint8Array(400).fill(90), 20, 20),
  });
  await opened.sheet();
  await page.getByRole("button", { name: "Leave out the photo" }).click();
  await opened.sheet();
  // Not `check`: the sheet closes with the click.
  await page.click("#resize-masks");
  await opened.shows("Own files");
});

test("a camera of a resized image is scaled, that of another image is not", async (opened, page) => {
  await drop(opened, otherCamera(2 * WIDTH, HEIGHT));
  assert.match((await problems(opened)).camera ?? "", /camera\.json: Found .*320 × 120/);
  await page.click("#intake-cancel");
  await drop(opened, otherCamera(2 * WIDTH, 2 * HEIGHT));
  await opened.shows("Own files");
  assert.ok((await opened.metric("iou")) > 0.9);
  await opened.click("#edit-files");
  await opened.sheet();
  assert.equal(await page.inputValue("#camera-cx"), `${pinhole.cx}`);
});
