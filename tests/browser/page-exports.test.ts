/** Exports of the page, read back by the library. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { type Aligner, createAligner, type Sim3Like } from "sim3align";
import { fromBop, fromFrame, toSim3 } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";
import { type SitePage, SiteTest, siteDir } from "../support/site.js";

let site: SiteTest;
let aligner: Aligner;
let opened: SitePage;
before(async () => {
  site = await SiteTest.start();
  aligner = await createAligner();
  opened = await site.open("#sample=mug", { permissions: ["clipboard-read", "clipboard-write"] });
});
after(() => site?.stop());

const sampleFile = (name: string) => Uint8Array.from(readFileSync(join(siteDir, "samples", "mug", name)));
const observation = () => ({
  depth: sampleFile("depth.png"),
  mask: sampleFile("mask.png"),
  cameraFile: sampleFile("camera.json"),
});

/** The IoU that the library measures for a mesh at a pose. */
async function iouOf(transform: Sim3Like, mesh = sampleFile("mesh.glb")): Promise<number> {
  return (await aligner.evaluate({ ...observation(), mesh }, transform)).metrics.iou ?? -1;
}

const near = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-3, `${a} and ${b}`);
const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

test("JSON and BOP contain the pose", async () => {
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
});

test("GLB and PLY contain the mesh at its pose", async () => {
  const iou = await opened.metric("iou");
  const glb = await opened.saved("GLB");
  // GLB files are in OpenGL's camera frame.
  const back = fromFrame(toSim3(still), "opengl");
  near(await iouOf(back, Uint8Array.from(glb.bytes)), iou);
  const ply = await opened.saved("PLY");
  near(await iouOf(still, Uint8Array.from(ply.bytes)), iou);
  const { positions } = await readMesh(Uint8Array.from(ply.bytes));
  assert.ok(positions.length > 1000);
});

test("both matrices are the same pose", async () => {
  const iou = await opened.metric("iou");
  const copied = async (name: string, says: RegExp) => {
    await opened.page.getByRole("button", { name, exact: true }).click();
    await opened.says(says);
    return JSON.parse(await opened.page.evaluate(() => navigator.clipboard.readText())) as number[];
  };
  const columns = await copied("Copy matrix (column-major)", /column-major/);
  assert.equal(await iouOf(columns), iou);
  const rows = await copied("Copy matrix (row-major)", /row-major/);
  assert.deepEqual(
    rows,
    columns.map((_, i) => columns[4 * (i % 4) + Math.floor(i / 4)]),
  );
});

test("the link restores the sample, and the view is saved as PNG", async () => {
  await opened.page.getByRole("button", { name: "Copy link" }).click();
  await opened.says(/^Copied the link/);
  const link = await opened.page.evaluate(() => navigator.clipboard.readText());
  assert.equal(new URL(link).hash, "#sample=mug");
  const picture = await opened.saved("PNG of the view");
  assert.equal(picture.bytes.subarray(0, 8).toString("latin1"), "\x89PNG\r\n\x1a\n");
  assert.ok(picture.bytes.length > 5000);
  await opened.close();
});
