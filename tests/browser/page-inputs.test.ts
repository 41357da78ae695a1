/** The user's own files: one drop is one scene, and only becomes it when everything fits. */
import assert from "node:assert/strict";
import { otherPose } from "../support/case-folder.js";
import { cocoRle, obj, png } from "../support/files.js";
import { depthInUnits, farther } from "../support/page-cases.js";
import {
  cameraFile,
  drop,
  dropFolder,
  type Files,
  files,
  HEIGHT,
  inFolder,
  jsonFile,
  maskPng,
  seen,
  WIDTH,
} from "../support/page-files.js";
import { mesh, pinhole, render } from "../support/scene.js";
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

test("two masks and one mesh are a question, which a click answers", async (opened, page) => {
  const { "mask.png": mask, ...rest } = files;
  await drop(opened, { ...rest, "mask-a.png": mask as Uint8Array, "mask-b.png": maskPng(other.mask) });
  const sheet = await opened.sheet();
  assert.match((await sheet.textContent()) ?? "", /No mesh for b\./);
  assert.ok(await page.isDisabled("#intake-open"));
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  await page.locator('[data-object="b"]').getByRole("button", { name: "Leave it out" }).click();
  await sheet.getByRole("button", { name: "They do" }).click();
  await opened.shows("Own files");
  assert.equal(await page.locator(".objects").count(), 0);
});

test("a label map and COCO annotations hold several masks", async (opened, page) => {
  const labels = seen.mask.map((inside, i) => (inside !== 0 ? 7 : other.mask[i] !== 0 ? 12 : 0));
  const { "mask.png": _, "mesh.obj": mesh, ...rest } = files;
  const meshes: Files = { "mesh-7.obj": mesh as Uint8Array, "obj_000012.obj": mesh as Uint8Array };
  await drop(opened, { ...rest, ...meshes, "labels.png": png(labels, WIDTH, HEIGHT) });
  await page.locator('main[data-scene="Own files"]').waitFor(PATIENCE);
  assert.deepEqual(await namesOf(opened), ["Object 7", "Object 12"]);
  const images = [{ id: 3, width: WIDTH, height: HEIGHT, file_name: "depth.jpg" }];
  const [u, v] = [Math.round(pinhole.cx), Math.round(pinhole.cy)];
  const square = [u - 12, v - 12, u + 12, v - 12, u + 12, v + 12, u - 12, v + 12];
  const annotations = [
    { image_id: 3, category_id: 1, segmentation: cocoRle(seen.mask, WIDTH, HEIGHT) },
    { image_id: 3, category_id: 2, segmentation: [square] },
    { image_id: 4, category_id: 2, segmentation: [square] },
  ];
  const categories = [
    { id: 1, name: "cup" },
    { id: 2, name: "blob" },
  ];
  const coco = jsonFile({ images, annotations, categories });
  const named: Files = { "blob.obj": mesh as Uint8Array, "cup.obj": mesh as Uint8Array };
  await dropFolder(opened, inFolder("coco", { ...rest, ...named, "instances.json": coco }));
  await page.locator('main[data-scene="coco"]').waitFor(PATIENCE);
  assert.deepEqual(await namesOf(opened), ["cup", "blob"]);
});

test("an image of a BOP data set is a scene of its own", async (opened, page) => {
  const K = [pinhole.fx, 0, pinhole.cx, 0, pinhole.fy, pinhole.cy, 0, 0, 1];
  const entry = { cam_K: K, depth_scale: 1 };
  const pose = (obj_id: number) => ({ obj_id, cam_R_m2c: [1, 0, 0, 0, 1, 0, 0, 0, 1], cam_t_m2c: [0, 0, 500] });
  const mask = maskPng(seen.mask);
  await dropFolder(opened, {
    "000048/depth/000001.png": depthPng,
    "000048/depth/000036.png": depthPng,
    "000048/mask_visib/000001_000000.png": mask,
    "000048/mask_visib/000036_000000.png": maskPng(other.mask),
    "000048/mask_visib/000036_000001.png": mask,
    "000048/mask/000036_000001.png": mask,
    "000048/scene_camera.json": jsonFile({ 1: entry, 36: entry }),
    "000048/scene_gt.json": jsonFile({ 1: [pose(5)], 36: [pose(2), pose(5)] }),
    "models/obj_000002.obj": meshFile,
    "models/obj_000005.obj": meshFile,
  });
  const sheet = await opened.sheet();
  // Nothing of the sample remains, and nothing of it is replaced yet.
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  await page.selectOption("#scene-choice", "1");
  await opened.sheet();
  assert.match((await sheet.locator('[data-field="depth"]').textContent()) ?? "", /000036\.png/);
  const meshes = await page
    .locator(".pair select")
    .evaluateAll((all) => all.map((one) => (one as HTMLSelectElement).selectedOptions[0]?.textContent));
  assert.deepEqual(meshes, ["models/obj_000002.obj", "models/obj_000005.obj"]);
  await page.selectOption("#scene-choice", "0");
  await opened.sheet();
  await page.click("#intake-open");
  await opened.shows("000048 000001");
  await page.click("#next");
  await opened.page.locator(".objects").waitFor(PATIENCE);
  assert.equal((await namesOf(opened)).length, 2);
});

test("case folders of one image are one scene, those of others are others", async (opened, page) => {
  await dropFolder(opened, { ...inFolder("a", files), ...inFolder("b", farther(0.01)) });
  await opened.sheet();
  assert.equal(await page.locator("#scene-choice option").count(), 2);
  assert.equal(await page.locator(".pair").count(), 1);
  await page.click("#intake-cancel");
  assert.equal(await page.getAttribute("main", "data-scene"), "Mug");
  const second = { ...files, "mask.png": maskPng(other.mask) };
  await dropFolder(opened, { ...inFolder("set/a", files), ...inFolder("set/b", second) });
  await opened.page.locator(".objects").waitFor(PATIENCE);
  assert.deepEqual(await namesOf(opened), ["a", "b"]);
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
