/** Scenes: what stands and what hangs, forms of masks, what is known of an object, and errors. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, type SceneAlignment, type SceneInput, type SceneResult } from "sim3align";
import { exportSceneGlb } from "sim3align/conventions";
import { cocoRle, glbJson, png } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { transformed } from "../support/scene.js";
import { labels, masks, plane, poses, standingGlb, standingMesh, tableScene, tableView } from "../support/table.js";

const here = await createAligner();

const quick = { quality: "fast" } as const;
const { width, height } = tableView;
const placed = ({ objects }: SceneResult): SceneAlignment[] =>
  objects.map((object) => {
    assert.ok(object.error === undefined, object.error?.message);
    return object;
  });
const poseOf = (result: SceneResult) => placed(result).map(({ matrix }) => matrix);

const found = await here.alignScene(tableScene, quick);

test("objects are where they are, and the table is found", () => {
  const { support, metrics } = found;
  assert.ok(support !== null && Math.abs(support.d - plane.d) < 0.003, `${support?.d}`);
  const cosine = support.normal.reduce((sum, x, i) => sum + x * (plane.normal[i] ?? 0), 0);
  assert.ok(cosine > 0.9999, `${support.normal}`);
  for (const [i, { name, scale, translation }] of placed(found).entries()) {
    const pose = poses[i] as (typeof poses)[0];
    assert.equal(name, `object ${i}`);
    assert.ok(Math.abs(scale / pose.scale - 1) < 0.05, `${i}: ${scale}`);
    const away = Math.hypot(...translation.map((x, k) => x - (pose.translation[k] ?? 0)));
    assert.ok(away < 0.01, `${i}: ${away}`);
  }
  const contacts = placed(found).map(({ contact }) => contact);
  for (const [i, { restsOn }] of contacts.entries()) assert.equal(restsOn, i < 2 ? "support" : null);
  assert.ok(Math.abs((contacts[2]?.gapM ?? 0) - 0.18) < 0.02, `${contacts[2]?.gapM}`);
  assert.deepEqual([metrics.aligned, metrics.resting], [3, 2]);
});

test("masks are images, RLEs or one label map", async () => {
  const forms: SceneInput[] = [
    { ...tableView, objects: masks.map((mask) => ({ mask: cocoRle(mask, width, height), mesh: standingMesh })) },
    { ...tableView, objects: masks.map((mask) => ({ mask: png(mask, width, height), mesh: standingMesh })) },
    { ...tableView, labels, objects: masks.map((_, i) => ({ label: i + 1, mesh: standingMesh })) },
  ];
  for (const scene of forms) assert.deepEqual(poseOf(await here.alignScene(scene, quick)), poseOf(found));
});

test("a plane that is passed is used, and what is known of an object goes before the options", async () => {
  const scale = (poses[0]?.scale ?? 1) * 1.02;
  const [first, ...others] = tableScene.objects;
  const scene = { ...tableScene, support: plane, objects: [{ ...(first as (typeof others)[0]), scale }, ...others] };
  const result = await here.alignScene(scene, quick);
  assert.ok(result.support?.confidence === 1 && Math.abs(result.support.d - plane.d) < 1e-9);
  const scales = placed(result).map((object) => Math.abs(object.scale / scale - 1));
  assert.ok((scales[0] ?? 1) < 1e-9 && (scales[1] ?? 0) > 1e-3, `${scales}`);
});

test("progress names its object and never decreases; a signal ends the scene", async () => {
  const seen: { fraction: number; index: number }[] = [];
  await here.alignScene(tableScene, { ...quick, onProgress: (progress) => seen.push(progress) });
  const fractions = seen.map(({ fraction }) => fraction);
  assert.ok(fractions.length > 3 && fractions.every((x, i) => x >= (fractions[i - 1] ?? 0)), `${fractions}`);
  assert.deepEqual([...new Set(seen.map(({ index }) => index))].sort(), [0, 1, 2]);
  const [abort, reason] = [new AbortController(), new Error("no longer needed")];
  const { signal } = abort;
  await assert.rejects(here.alignScene(tableScene, { signal, onProgress: () => abort.abort(reason) }), reason);
});

test("an object that cannot be aligned leaves the others", async () => {
  const [first, second] = tableScene.objects as [SceneInput["objects"][0], SceneInput["objects"][0]];
  const empty = { ...second, mask: new Uint8Array(width * height) };
  const broken = { ...second, mesh: new Uint8Array([1, 2, 3]) };
  const { objects } = await here.alignScene({ ...tableScene, objects: [first, empty, broken] }, quick);
  const [aligned, failed, unread] = objects;
  assert.equal(unread?.error?.argument, "mesh");
  assert.deepEqual([aligned?.error, failed?.error?.code, failed?.name], [undefined, "EMPTY_MASK", "object 1"]);
});

test("a scene is exported as one GLB with the support as ground", async () => {
  const objects = placed(found).map((transform, i) => ({
    ...{ name: transform.name, mesh: i === 0 ? standingMesh : standingGlb, transform },
  }));
  const camera = { fy: tableView.camera.fy, width, height };
  const bytes = exportSceneGlb(objects, { support: found.support, camera });
  assert.equal((await assertValid(bytes)).totalTriangleCount, standingMesh.indices.length + 2);
  const { nodes } = glbJson(bytes);
  const names = nodes.map(({ name }: { name?: string }) => name);
  for (const name of ["object 0", "object 1", "object 2", "camera", "support", "view"]) {
    assert.ok(names.includes(name), name);
  }
  // The view turns the normal of the support to y.
  const { normal, d } = found.support ?? { normal: [0, 0, 0] as const, d: 0 };
  const points = [-normal[0] * d, -normal[1] * d, -normal[2] * d, 0, 0, 0];
  const foot = transformed(points, { scale: 1, ...nodes[names.indexOf("view")] });
  assert.ok(Math.abs(foot[1] ?? 1) < 1e-9 && Math.abs((foot[4] ?? 0) - d) < 1e-9, `${foot}`);
});
