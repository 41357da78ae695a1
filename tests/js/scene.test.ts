/** Scenes: what stands and what hangs, forms of masks, what is known of an object, and errors. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, type SceneAlignment, type SceneInput, type SceneResult } from "sim3align";
import { exportSceneGlb, toSim3 } from "sim3align/conventions";
import { cocoRle, glbJson, png } from "../support/files.js";
import { assertValid, gltfOf } from "../support/gltf-validator.js";
import { transformed } from "../support/scene.js";
import { labels, masks, standingGlb, standingMesh, tableScene, tableView } from "../support/table.js";

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

test("masks are images, RLEs or one label map", async () => {
  const forms: SceneInput[] = [
    { ...tableView, objects: masks.map((mask) => ({ mask: cocoRle(mask, width, height), mesh: standingMesh })) },
    { ...tableView, objects: masks.map((mask) => ({ mask: png(mask, width, height), mesh: standingMesh })) },
    { ...tableView, labels, objects: masks.map((_, i) => ({ label: i + 1, mesh: standingMesh })) },
  ];
  for (const scene of forms) assert.deepEqual(poseOf(await here.alignScene(scene, quick)), poseOf(found));
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

test("a moving object and a moving camera are animated, with a key for each pose", async () => {
  const motion = [0, 1, 2].map((i) => ({
    timeS: i / 30,
    transform: toSim3({ scale: 1 + i, rotation: [0, Math.sin(i), 0, Math.cos(i)], translation: [0.1 * i, 0, 1] }),
  }));
  const camera = { fy: tableView.camera.fy, width, height, motion };
  for (const mesh of [standingMesh, standingGlb]) {
    const bytes = exportSceneGlb([{ name: "toy", mesh, transform: motion[0]?.transform ?? [], motion }], { camera });
    await assertValid(bytes);
    const [{ tracks } = { tracks: [] }] = (await gltfOf(bytes)).animations;
    const values = Object.fromEntries(tracks.map((track) => [track.name, [...track.values]]));
    assert.deepEqual(values["toy.scale"], [1, 1, 1, 2, 2, 2, 3, 3, 3]);
    assert.deepEqual(values["camera.position"], values["toy.position"]);
  }
  const backwards = [...motion].reverse();
  const broken = { name: "toy", mesh: standingMesh, transform: motion[0]?.transform ?? [], motion: backwards };
  assert.throws(() => exportSceneGlb([broken]), { code: "INVALID_ARGUMENT", argument: "objects[0].motion[1].timeS" });
});
