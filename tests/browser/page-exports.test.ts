/** Exports of the page, read back by the library. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { createAligner, type Sim3Like } from "sim3align";
import { fromBop, fromFrame, toSim3 } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";
import { WEBGL } from "../support/browser.js";
import { pageTests, siteDir } from "../support/site.js";

const test = pageTests(WEBGL);

const sampleFile = (name: string) => Uint8Array.from(readFileSync(join(siteDir, "samples", "mug", name)));
const observation = () => ({
  depth: sampleFile("depth.png"),
  mask: sampleFile("mask.png"),
  cameraFile: sampleFile("camera.json"),
});

/** The IoU that the library measures for a mesh at a pose. */
async function iouOf(transform: Sim3Like, mesh = sampleFile("mesh.glb")): Promise<number> {
  return (await (await createAligner()).evaluate({ ...observation(), mesh }, transform)).metrics.iou ?? -1;
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
