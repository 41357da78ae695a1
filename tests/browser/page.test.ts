/** The page after opening: its sample is aligned, and display, numbers and exports agree with the library. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { createAligner, type Sim3Like } from "sim3align";
import { fromBop, fromFrame, toSim3 } from "sim3align/conventions";
import { readMask, readMesh } from "sim3align/formats";
import { maskIou } from "../support/results.js";
import { pageTests, siteDir } from "../support/site.js";

const test = pageTests();

const sampleFile = (name: string) => Uint8Array.from(readFileSync(join(siteDir, "samples", "mug", name)));
const sample = {
  depth: sampleFile("depth.png"),
  mask: sampleFile("mask.png"),
  mesh: sampleFile("mesh.glb"),
  cameraFile: sampleFile("camera.json"),
};

test("the page aligns its sample as the library does, and draws the pose that it measures", async (opened, page) => {
  const quality = (await page.inputValue("#effort")) as "fast" | "balanced";
  const { metrics, confidence } = await (await createAligner()).align(sample, { quality });
  assert.equal(await opened.metric("iou"), metrics.iou);
  assert.equal(await opened.metric("depthMaeM"), metrics.depthMaeM);
  assert.match((await page.textContent("#confidence")) ?? "", new RegExp(`^${Math.round(100 * confidence)} %`));
  assert.equal((await opened.dimensions()).length, 3);
  assert.match((await page.textContent("#errors")) ?? "", /scale [\d.]+ %/);

  // The displayed silhouette has the measured IoU.
  const mask = await readMask(sample.mask);
  // Without outlines, the two images differ by the silhouette only.
  await opened.showInImage("outline", false);
  const shown = await opened.imagePixels();
  await opened.showInImage("silhouette", false);
  const bare = await opened.imagePixels();
  assert.deepEqual([shown.width, shown.height], [mask.width, mask.height]);
  const isDrawn = (pixel: number) => [0, 1, 2].some((k) => shown.data[4 * pixel + k] !== bare.data[4 * pixel + k]);
  const drawn = maskIou(
    Array.from(mask.data, (_, pixel) => Number(isDrawn(pixel))),
    mask.data,
  );
  const iou = metrics.iou ?? 0;
  assert.ok(iou > 0.5 && Math.abs(drawn - iou) < 0.002, `drawn ${drawn}, measured ${iou}`);
});

test("every sample can be chosen, and is aligned", async (opened, page) => {
  const ids = await page.$$eval("[data-sample]", (found) =>
    found.map((one) => (one as HTMLButtonElement).dataset.sample ?? ""),
  );
  assert.ok(ids.length >= 4, ids.join());
  for (const id of ids.slice(1)) {
    await opened.sample(id);
    await page.waitForFunction((id) => location.hash.includes(`sample=${id}`), id);
    await opened.aligned();
    assert.ok((await opened.metric("iou")) > 0.3, id);
  }
});

const link = "#sample=desk&quality=fast&seed=7&symmetry=none";
test("a link holds the sample and the options", link, async (opened, page) => {
  const isShown = async (values: Record<string, string>) => {
    assert.equal(await page.getAttribute('[data-sample="desk"]', "aria-pressed"), "true");
    for (const [id, value] of Object.entries(values)) assert.equal(await page.inputValue(`#${id}`), value);
  };
  await isShown({ effort: "fast", "option-seed": "7", "option-symmetry": "none" });
  assert.equal(await page.locator(".objects .name").count(), 3);
  await opened.choose("#effort", "best");
  // The address is that of a link now.
  await page.reload();
  await opened.aligned();
  await isShown({ effort: "best", "option-seed": "7", "option-symmetry": "none" });
});

/** The IoU that the library measures for a mesh at a pose. */
async function iouOf(transform: Sim3Like, mesh = sample.mesh): Promise<number> {
  return (await (await createAligner()).evaluate({ ...sample, mesh }, transform)).metrics.iou ?? -1;
}

const near = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-3, `${a} and ${b}`);
const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

test("JSON, BOP, GLB and PLY contain the pose", async (opened) => {
  const iou = await opened.metric("iou");
  const json = await opened.saved("JSON");
  assert.equal(json.name, "mug.json");
  const { Mug } = JSON.parse(json.bytes.toString()) as {
    Mug: { scale: number; rotation: number[][]; matrix: number[] };
  };
  assert.equal(await iouOf(Mug.matrix), iou);
  near(await iouOf(Mug as never), iou);
  const bop = await opened.saved("BOP JSON");
  const [entry] = (JSON.parse(bop.bytes.toString()) as Record<string, Parameters<typeof fromBop>[0][]>)["0"] ?? [];
  assert.ok(entry !== undefined);
  const perUnit = (entry as unknown as { model_mm_per_mesh_unit: number }).model_mm_per_mesh_unit;
  near(await iouOf(fromBop(entry, { scale: perUnit / 1000 })), iou);
  const glb = await opened.saved("GLB");
  // GLB files are in OpenGL's camera frame.
  const back = fromFrame(toSim3(still), "opengl");
  near(await iouOf(back, Uint8Array.from(glb.bytes)), iou);
  const ply = await opened.saved("PLY");
  near(await iouOf(still, Uint8Array.from(ply.bytes)), iou);
  const { positions } = await readMesh(Uint8Array.from(ply.bytes));
  assert.ok(positions.length > 1000);
});
