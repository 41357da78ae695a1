/** The user's own files: chosen, dropped, zipped, invalid. */
import assert from "node:assert/strict";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { zipSync } from "fflate";
import { otherPose } from "../support/case-folder.js";
import { required } from "../support/environment.js";
import { cocoRle, npy, obj, png } from "../support/files.js";
import { mesh, render, truth } from "../support/scene.js";
import { type SitePage, SiteTest } from "../support/site.js";

let site: SiteTest;
before(async () => {
  site = await SiteTest.start();
});
after(() => site?.stop());

/** Files by name. */
type Files = Record<string, Uint8Array>;

const pinhole = { fx: 300, fy: 301, cx: 79.5, cy: 60 };
const seen = render(mesh, truth, pinhole, 160, 120);
const camera = Buffer.from(JSON.stringify({ ...pinhole, width: 160, height: 120 }));
const files: Files = {
  "depth.npy": npy(seen.depth, 120, 160),
  "mask.png": png(
    seen.mask.map((value) => 255 * value),
    160,
    120,
  ),
  "camera.json": camera,
  "mesh.obj": obj(mesh),
};

/** Drops files on the page. */
async function drop({ page }: SitePage, dropped: Files): Promise<void> {
  const encoded = Object.entries(dropped).map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]);
  const data = await page.evaluateHandle((parts) => {
    const transfer = new DataTransfer();
    for (const [name = "", base64 = ""] of parts) {
      const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
      transfer.items.add(new File([bytes], name));
    }
    return transfer;
  }, encoded);
  await page.dispatchEvent("body", "dragenter", { dataTransfer: data });
  assert.ok(await page.isVisible(".drop-here"));
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
}

async function aligns(opened: SitePage): Promise<void> {
  await opened.says(/Ready to align/);
  await opened.page.click("#align");
  await opened.aligned();
}

test("dropped files make a scene, which is aligned to its true size", async () => {
  const opened = await site.open();
  await drop(opened, files);
  await aligns(opened);
  assert.ok((await opened.metric("iou")) > 0.9);
  const scale = Number.parseFloat((await opened.page.textContent(".facts dd")) ?? "");
  assert.ok(Math.abs(scale / truth.scale - 1) < 0.05, `${scale}`);
  assert.ok(!opened.page.url().includes("sample="), "a link that shows others another scene");
  await opened.close();
});

test("a zip of a folder with several masks and meshes makes several objects", async () => {
  const opened = await site.open();
  const other = render(mesh, otherPose(2), pinhole, 160, 120);
  const zipped = zipSync({
    "scene/depth.png": png(
      Uint16Array.from(seen.depth, (z) => Math.round(1000 * z)),
      160,
      120,
    ),
    "scene/camera.json": camera,
    "scene/mask-left.json": Buffer.from(JSON.stringify(cocoRle(seen.mask, 160, 120))),
    "scene/mask-right.png": png(other.mask, 160, 120),
    "scene/mesh-left.obj": obj(mesh),
    "scene/mesh-right.obj": obj(mesh),
    "__MACOSX/scene/._depth.png": Uint8Array.of(1),
  });
  await drop(opened, { "scene.zip": zipped });
  await opened.says(/^scene: .* 2 objects/);
  assert.deepEqual(await opened.page.locator(".objects .name").allTextContents(), ["left", "right"]);
  await opened.page.click("#align-all");
  await opened.says(/^Aligned 2 objects/);
  await opened.close();
});

test("an invalid file shows an error with a remedy at its field", async () => {
  const opened = await site.open();
  const { page } = opened;
  const choose = (field: string, name: string, bytes: Uint8Array) =>
    page.setInputFiles(`#${field}-file`, { name, mimeType: "", buffer: Buffer.from(bytes) });
  const error = async (field: string) => {
    await page.locator(`#${field}-error`).waitFor();
    assert.equal(await page.getAttribute(`#${field}-file`, "aria-describedby"), `${field}-error`);
    return (await page.textContent(`#${field}-error`)) ?? "";
  };
  await choose("depth", "depth.png", png(new Uint8Array(160 * 120).fill(9), 160, 120));
  assert.match(await error("depth"), /8.bit.*expected.*16/i);
  await choose("depth", "depth.npy", files["depth.npy"] as Uint8Array);
  // The sample's camera and mask are of another size.
  assert.match(await error("camera"), /160 × 120/);
  await choose("camera", "camera.json", camera);
  assert.match(await error("mask"), /640 × 480 pixels, expected 160 × 120, the size of the depth map.*Resize/);
  await choose("mask", "mask.png", files["mask.png"] as Uint8Array);
  await choose("mesh", "mesh.glb", Uint8Array.of(103, 108, 84, 70, 1));
  assert.match(await error("mesh"), /expected/);
  await choose("mesh", "mesh.obj", files["mesh.obj"] as Uint8Array);
  await aligns(opened);
  await choose("photo", "photo.jpg", Uint8Array.of(1, 2, 3));
  assert.match(await error("photo"), /cannot decode/);
  await opened.close();
});

test("errors of the alignment are shown at the field that they concern", async () => {
  const opened = await site.open();
  await drop(opened, { ...files, "mask.png": png(new Uint8Array(160 * 120), 160, 120) });
  await opened.says(/Ready to align/);
  await opened.page.click("#align");
  await opened.page.locator("#mask-error").waitFor();
  assert.match((await opened.page.textContent("#mask-error")) ?? "", /mask|pixel/i);
  await opened.close();
});

test("intrinsics can be entered, or assumed with a warning", async () => {
  const opened = await site.open();
  const { page } = opened;
  await drop(opened, files);
  await opened.says(/Ready to align/);
  await page.click('[data-field="camera"] summary');
  await page.fill("#camera-fov", "45");
  await page.press("#camera-fov", "Enter");
  await aligns(opened);
  assert.match((await page.textContent(".warnings")) ?? "", /assumed/);
  const assumed = await opened.dimensions();
  for (const [name, value] of Object.entries(pinhole)) {
    await page.fill(`#camera-${name}`, `${value}`);
    await page.press(`#camera-${name}`, "Enter");
    await opened.says(/Ready to align/);
  }
  await aligns(opened);
  assert.equal(await page.locator(".warnings").count(), 0);
  assert.notDeepEqual(await opened.dimensions(), assumed);
  await opened.close();
});

const cases = process.env.SIM3ALIGN_CASES;
const isThere = cases !== undefined && existsSync(cases);
test("a real case is dropped, shown and aligned", {
  skip: isThere ? false : "SIM3ALIGN_CASES is not set",
}, async () => {
  const folder = readdirSync(required("SIM3ALIGN_CASES"), { withFileTypes: true }).find((entry) => entry.isDirectory());
  const path = join(required("SIM3ALIGN_CASES"), folder?.name ?? "");
  const names = readdirSync(path).filter((name) => !name.startsWith("."));
  const opened = await site.open();
  await drop(opened, Object.fromEntries(names.map((name) => [name, readFileSync(join(path, name))])));
  await aligns(opened);
  assert.ok((await opened.metric("iou")) > 0.5);
  await opened.close();
});
