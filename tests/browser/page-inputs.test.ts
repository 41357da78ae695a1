/** The user's own files: one drop is one scene, and only becomes it when everything fits; what is wrong is named at its field. */
import assert from "node:assert/strict";
import { resizeInput } from "sim3align/conventions";
import { cocoRle, maskPng as maskFile, obj, png } from "../support/files.js";
import {
  cameraFile,
  choose,
  depthInUnits,
  depthNpy,
  drop,
  dropFolder,
  type Files,
  farther,
  files,
  HEIGHT,
  inFolder,
  jsonFile,
  maskPng,
  otherCamera,
  seen,
  WIDTH,
} from "../support/page-files.js";
import { mesh, otherPose, pinhole, render } from "../support/scene.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests();

/** A second object beside the first. */
const other = render(mesh, otherPose(2), pinhole, WIDTH, HEIGHT);
const depthPng = depthInUnits(1000)["depth.png"] as Uint8Array;
const meshFile = obj(mesh);

const namesOf = (opened: SitePage) => opened.page.locator(".objects .name").allTextContents();

test("masks and meshes are paired by name, in any order", async (opened) => {
  await dropFolder(opened, {
    "desk/depth.png": depthPng,
    "desk/camera.json": cameraFile,
    "desk/b_mesh.obj": meshFile,
    "desk/left-mug.obj": meshFile,
    "desk/masks/B.png": maskPng(other.mask),
    "desk/masks/mug_left.json": jsonFile(cocoRle(seen.mask, WIDTH, HEIGHT)),
    "__MACOSX/desk/._depth.png": Uint8Array.of(1),
  });
  await opened.shows("desk");
  // As in the files: an annotator compares them.
  assert.deepEqual(await namesOf(opened), ["B", "mug_left"]);
});

test("two masks and one mesh are a question, which a choice answers", async (opened, page) => {
  const { "mask.png": mask, ...rest } = files;
  await drop(opened, { ...rest, "mask-a.png": mask as Uint8Array, "mask-b.png": maskPng(other.mask) });
  const sheet = await opened.sheet();
  assert.match((await sheet.textContent()) ?? "", /No mesh for a\..*No mesh for b\./s);
  assert.ok(await page.isDisabled("#intake-open"));
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  await page.getByLabel("Mesh of a", { exact: true }).selectOption({ label: "mesh.obj" });
  await opened.sheet();
  await page.locator('[data-object="b"]').getByRole("button", { name: "Leave it out" }).click();
  await opened.shows("Own files");
  assert.equal(await page.locator(".objects").count(), 0);
});

test("a file whose name says nothing is asked about, and a second drop joins the first", async (opened, page) => {
  const { "mask.png": mask, "camera.json": camera, ...rest } = files;
  await drop(opened, { ...rest, "1.png": mask as Uint8Array });
  await drop(opened, { "camera.json": camera as Uint8Array });
  await page.locator('[data-field="camera"]', { hasText: "camera.json" }).waitFor(PATIENCE);
  const sheet = await opened.sheet();
  assert.match((await sheet.textContent()) ?? "", /1\.png: not used\. Choose below what each file is\./);
  await page.getByLabel("Use of 1.png").selectOption("mask");
  await opened.shows("Own files");
});

test("images of one folder, and case folders, are scenes of their own", async (opened, page) => {
  await dropFolder(opened, {
    "48/depth/000001.png": depthPng,
    "48/depth/000036.png": depthPng,
    "48/masks/000001_cup.png": maskPng(seen.mask),
    "48/masks/000036_cup.png": maskPng(other.mask),
    "48/masks/000036_box.png": maskPng(seen.mask),
    "48/camera.json": cameraFile,
    "48/mesh/box.obj": meshFile,
    "48/mesh/cup.obj": meshFile,
  });
  const sheet = await opened.sheet();
  // Nothing of the sample remains, and nothing of it is replaced yet.
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  await page.selectOption("#scene-choice", "1");
  await opened.sheet();
  assert.match((await sheet.locator('[data-field="depth"]').textContent()) ?? "", /000036\.png/);
  // The camera file has one camera, which has no number.
  assert.equal(await sheet.locator('.card[data-field="camera"]').getAttribute("data-wrong"), "false");
  const meshes = await page
    .locator(".pair select")
    .evaluateAll((all) => all.map((one) => (one as HTMLSelectElement).selectedOptions[0]?.textContent));
  assert.deepEqual(meshes, ["mesh/box.obj", "mesh/cup.obj"]);
  // Another drop is beside them.
  await dropFolder(opened, { ...inFolder("a", files), ...inFolder("b", farther(0.01)) });
  await page
    .locator("#scene-choice option")
    .nth(3)
    .waitFor({ ...PATIENCE, state: "attached" });
  await opened.sheet();
  assert.deepEqual(
    (await page.locator("#scene-choice option").allTextContents()).map((text) => text.replace(/^.*: | \(.*$/g, "")),
    ["48 000001", "48 000036", "a", "b"],
  );
  assert.equal(await page.locator(".pair").count(), 1);
  await page.click("#intake-cancel");
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
});

test("mask and mesh dropped on an own scene replace what they name, if that is wanted", async (opened, page) => {
  await drop(opened, files);
  await opened.shows("Own files");
  const again: Files = { "mask.png": maskPng(other.mask), "mesh.obj": meshFile };
  await drop(opened, again);
  await opened.sheet();
  assert.match((await page.textContent("#for-shown")) ?? "", /mask\.png, mesh\.obj: for Own files, or a new scene\?/);
  await page.click("#new-scene");
  const sheet = await opened.sheet();
  assert.match((await sheet.textContent()) ?? "", /Depth map missing/);
  assert.equal(await page.locator("#for-shown").count(), 0);
  await page.click("#intake-cancel");
  await drop(opened, { "mask.png": maskPng(seen.mask.map((inside, i) => (i % WIDTH < 79 ? inside : 0))) });
  await opened.sheet();
  await page.click("#put-into-shown");
  await opened.sheet();
  assert.equal(await page.locator(".pair").count(), 1);
  assert.match((await page.locator('[data-field="depth"]').first().textContent()) ?? "", /depth\.npy/);
  const kept = await page.locator(".file-roles summary").textContent();
  assert.match(kept ?? "", /4 files/);
  await page.click("#intake-open");
  await opened.shows("Own files");
  assert.ok((await opened.metric("iou")) > 0.3);
});

test("a camera as text is the camera, of two one is used, and any unit can be entered", async (opened, page) => {
  const { "camera.json": _, ...rest } = files;
  const { fx, fy, cx, cy } = pinhole;
  const text = Buffer.from(`${fx} 0 ${cx}\n0 ${fy} ${cy}\n0 0 1\n`);
  await drop(opened, { ...rest, "intrinsic_color.txt": text, "intrinsic_depth.txt": text });
  const sheet = await opened.sheet();
  const doubt = await sheet.locator('[data-field="camera"] .doubt').textContent();
  assert.match(doubt ?? "", /intrinsic_depth\.txt is used, intrinsic_color\.txt not\./);
  await page.click("#intake-cancel");
  await drop(opened, { ...rest, "K.txt": text });
  await opened.shows("Own files");
  await opened.click("#edit-files");
  await opened.sheet();
  assert.equal(Number(await page.inputValue("#camera-fx")), Number(fx.toPrecision(7)));
  await page.fill("#depth-factor", "0.3");
  await page.press("#depth-factor", "Enter");
  await opened.sheet();
  assert.equal(await page.inputValue("#depth-scale"), "0.3");
  assert.match((await page.textContent("#depth-unit")) ?? "", /0\.3 m \(depthScale\)/);
});

test("intrinsics can be entered, or assumed with a warning", async (opened, page) => {
  const { "camera.json": _, ...rest } = files;
  await drop(opened, rest);
  await opened.sheet();
  await page.getByRole("button", { name: "Use 50° field of view" }).click();
  await opened.shows("Own files");
  assert.match((await page.textContent(".warnings")) ?? "", /assumed/);
  const assumed = await opened.dimensions();
  await opened.click("#edit-files");
  await opened.sheet();
  for (const [name, value] of Object.entries(pinhole)) {
    await page.fill(`#camera-${name}`, `${value}`);
    await page.press(`#camera-${name}`, "Enter");
    await opened.sheet();
  }
  await page.click("#intake-open");
  await opened.aligned();
  assert.doesNotMatch((await page.locator(".warnings").allTextContents()).join(), /assumed/);
  assert.notDeepEqual(await opened.dimensions(), assumed);
});

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
  await t.test("a damaged depth map, beside which mask and mesh are shown", async () => {
    await drop(opened, { ...files, "depth.npy": Uint8Array.of(1, 2, 3) });
    assert.deepEqual(Object.keys(await problems(opened)), ["depth"]);
    for (const of of ["Mask of", "Mesh for"]) await page.locator(`.pair canvas[aria-label^="${of}"]`).waitFor(PATIENCE);
  });
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

test("a depth map that looks backwards is turned around, and a video file is named", async (opened, page) => {
  await drop(opened, { "clip.mp4": Uint8Array.of(0) });
  assert.match((await (await opened.sheet()).textContent()) ?? "", /Save the frames of the video as pictures/);
  await page.click("#intake-cancel");
  await drop(opened, { ...files, "depth.npy": depthNpy(seen.depth.map((z) => -z)) });
  const sheet = await opened.sheet();
  assert.doesNotMatch((await sheet.textContent()) ?? "", /\bPass\b/);
  await page.getByRole("button", { name: "Flip the sign" }).click();
  await opened.shows("Own files");
  assert.ok((await opened.metric("iou")) > 0.9);
});

test("pasted files are opened", async (opened, page) => {
  const content = Object.entries(files).map(([name, bytes]) => [name, [...bytes]] as const);
  await page.evaluate((content) => {
    const data = new DataTransfer();
    for (const [name, bytes] of content) data.items.add(new File([Uint8Array.from(bytes)], name));
    document.body.dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true }));
  }, content);
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
