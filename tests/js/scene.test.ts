/** Scenes: what stands and what hangs, the same bits for any number of workers, forms of masks, and errors. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { createAligner, type SceneAlignment, type SceneInput, type SceneResult } from "sim3align";
import { exportSceneGlb } from "sim3align/conventions";
import { type Fault, rejectsWith } from "../support/errors.js";
import { cocoRle, glbJson, png } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { withoutTimes } from "../support/results.js";
import { transformed } from "../support/scene.js";
import { labels, masks, plane, poses, standingGlb, standingMesh, tableScene, tableView } from "../support/table.js";

const here = await createAligner();
const pool = await createAligner({ workers: 2 });
after(() => pool.dispose());

const quick = { quality: "fast" } as const;
const placed = ({ objects }: SceneResult): SceneAlignment[] =>
  objects.map((object) => {
    assert.ok(object.error === undefined, object.error?.message);
    return object;
  });
const timeless = (result: SceneResult) => ({ ...result, objects: placed(result).map(withoutTimes) });

const expected = await here.alignScene(tableScene, quick);

test("objects are where they are, and the table is found", () => {
  const { support, metrics } = expected;
  assert.ok(support !== null);
  const cosine = support.normal.reduce((sum, x, i) => sum + x * (plane.normal[i] ?? 0), 0);
  assert.ok(cosine > 0.9999, `${support.normal}`);
  assert.ok(Math.abs(support.d - plane.d) < 0.003, `${support.d}`);
  for (const [i, object] of placed(expected).entries()) {
    const pose = poses[i];
    assert.ok(pose !== undefined && object.name === `object ${i}`);
    assert.ok(Math.abs(object.scale / pose.scale - 1) < 0.05, `${i}: ${object.scale}`);
    const away = Math.hypot(...object.translation.map((x, k) => x - (pose.translation[k] ?? 0)));
    assert.ok(away < 0.01, `${i}: ${away}`);
  }
  const [first, second, third] = placed(expected).map(({ contact }) => contact);
  assert.equal(first?.restsOn, "support");
  assert.equal(second?.restsOn, "support");
  assert.equal(third?.restsOn, null);
  assert.ok(Math.abs((third?.gapM ?? 0) - 0.18) < 0.02, `${third?.gapM}`);
  assert.equal(metrics.aligned, 3);
  assert.equal(metrics.resting, 2);
});

test("any number of workers gives the same bits", async () => {
  assert.deepEqual(timeless(await pool.alignScene(tableScene, quick)), timeless(expected));
});

test("masks are images, RLEs or one label map", async () => {
  const { width, height } = tableView;
  const forms: SceneInput[] = [
    { ...tableView, objects: masks.map((mask) => ({ mask: cocoRle(mask, width, height), mesh: standingMesh })) },
    { ...tableView, objects: masks.map((mask) => ({ mask: png(mask, width, height), mesh: standingMesh })) },
    { ...tableView, labels, objects: masks.map((_, i) => ({ label: i + 1, mesh: standingMesh })) },
  ];
  const bare = timeless(expected).objects.map(({ name: _, ...object }) => object);
  for (const scene of forms) assert.deepEqual(timeless(await here.alignScene(scene, quick)).objects, bare);
});

test("an object without a mesh hides what is behind it", async () => {
  const [first, second, third] = tableScene.objects;
  assert.ok(first && second && third);
  const scene = { ...tableView, objects: [first, third], occluders: [second.mask] };
  const { objects } = await here.alignScene(scene, quick);
  assert.equal(objects.length, 2);
  const labelled = {
    ...tableView,
    labels,
    objects: [
      { label: 1, mesh: standingMesh },
      { label: 3, mesh: standingMesh },
    ],
  };
  const again = await here.alignScene(labelled, quick);
  assert.deepEqual(
    placed(again).map(({ matrix }) => matrix),
    objects.map((object) => (object.error === undefined ? object.matrix : [])),
  );
});

test("one object without support is align", async () => {
  const [mask] = masks;
  assert.ok(mask);
  const { depthUnit, ...alone } = withoutTimes(await here.align({ ...tableView, mask, mesh: standingMesh }, quick));
  const scene = { ...tableView, objects: [{ mask, mesh: standingMesh }], support: null };
  const result = await here.alignScene(scene, quick);
  assert.equal(result.support, null);
  const [object] = placed(result).map(withoutTimes);
  const { contact, ...rest } = object ?? {};
  assert.deepEqual(rest, alone);
  assert.equal(result.depthUnit, depthUnit);
  assert.deepEqual(contact, { restsOn: null, gapM: null, sharedVolume: 0, snappedM: 0 });
});

test("snap puts objects onto the support, and the pose says so", async () => {
  const result = await here.alignScene(tableScene, { ...quick, snap: true });
  const { normal, d } = result.support ?? { normal: [0, 0, 0], d: 0 };
  for (const [i, object] of placed(result).entries()) {
    const before = placed(expected)[i];
    const moved = object.translation.map((x, k) => x - (before?.translation[k] ?? 0));
    for (const [k, x] of moved.entries()) {
      assert.ok(Math.abs(x - (normal[k] ?? 0) * object.contact.snappedM) < 1e-9, `${i}: ${moved}`);
    }
    assert.deepEqual(object.matrix.slice(12, 15), object.translation);
    if (object.contact.restsOn !== null) assert.ok(Math.abs(object.contact.gapM ?? 1) < 1e-9);
  }
  assert.ok(d > 0);
});

test("objects are fitted in their proportions, which move with them", async () => {
  const fitted = async (snap: boolean) =>
    placed(await here.alignScene(tableScene, { ...quick, snap, proportions: "axes" }));
  const [before, after] = [await fitted(false), await fitted(true)];
  for (const [i, object] of after.entries()) {
    const [own, moved] = [before[i]?.proportions, object.proportions];
    assert.ok(own !== undefined && moved !== undefined);
    assert.deepEqual(moved.stretch, own.stretch);
    assert.deepEqual(moved.matrix.slice(12, 15), moved.translation);
    for (const k of [0, 1, 2] as const) {
      const by = object.translation[k] - (before[i]?.translation[k] ?? 0);
      assert.ok(Math.abs(moved.translation[k] - own.translation[k] - by) < 1e-9, `${i}`);
    }
  }
});

test("a given plane is used, with confidence 1", async () => {
  const { support } = await here.alignScene({ ...tableScene, support: plane }, quick);
  assert.equal(support?.confidence, 1);
  assert.ok(Math.abs((support?.d ?? 0) - plane.d) < 1e-9);
});

test("what is known of an object goes before the options", async () => {
  const scale = (poses[0]?.scale ?? 1) * 1.02;
  const [first, ...others] = tableScene.objects;
  assert.ok(first);
  const scene = { ...tableScene, objects: [{ ...first, scale }, ...others] };
  const [known, second] = placed(await here.alignScene(scene, quick));
  assert.ok(Math.abs((known?.scale ?? 0) / scale - 1) < 1e-9);
  assert.ok(Math.abs((second?.scale ?? 0) / scale - 1) > 1e-3);
});

test("prepared meshes give the same bits", async () => {
  for (const aligner of [here, pool]) {
    const prepared = await aligner.prepareMesh(standingMesh);
    const scene = { ...tableScene, objects: tableScene.objects.map((object) => ({ ...object, mesh: prepared })) };
    assert.deepEqual(timeless(await aligner.alignScene(scene, quick)), timeless(expected));
    prepared.dispose();
    await rejectsWith(() => aligner.alignScene(scene, quick), "DISPOSED mesh", /disposed/);
  }
});

test("progress never decreases and names its object", async () => {
  const fractions: number[] = [];
  const indices = new Set<number>();
  await here.alignScene(tableScene, {
    ...quick,
    onProgress: ({ fraction, index }) => {
      fractions.push(fraction);
      indices.add(index);
    },
  });
  assert.ok(fractions.length > 3);
  assert.deepEqual(
    fractions,
    [...fractions].sort((a, b) => a - b),
  );
  assert.deepEqual([...indices].sort(), [0, 1, 2]);
});

test("a scene can be cancelled, and an exception of onProgress ends it", async () => {
  for (const aligner of [here, pool]) {
    const abort = new AbortController();
    const reason = new Error("no longer needed");
    const running = aligner.alignScene(tableScene, { signal: abort.signal, onProgress: () => abort.abort(reason) });
    await assert.rejects(running, reason);
    const failed = new Error("mine");
    const throwing = aligner.alignScene(tableScene, {
      onProgress: () => {
        throw failed;
      },
    });
    await assert.rejects(throwing, failed);
    assert.equal((await aligner.alignScene(tableScene, quick)).objects.length, 3);
  }
});

test("a signal without a reason ends a scene as an abort", async () => {
  const controller = new AbortController();
  // As in older implementations.
  Object.defineProperty(controller.signal, "reason", { value: undefined });
  const running = here.alignScene(tableScene, { ...quick, signal: controller.signal });
  controller.abort();
  await assert.rejects(running, { name: "AbortError" });
});

test("arrays that are moved while a scene is aligned are refused by name", async () => {
  const depth = tableView.depth.slice();
  const move = () => depth.length > 0 && structuredClone(depth, { transfer: [depth.buffer] });
  await rejectsWith(
    () => here.alignScene({ ...tableScene, depth }, { ...quick, onProgress: move }),
    "INVALID_ARGUMENT depth",
    /detached/,
  );
  assert.deepEqual(timeless(await here.alignScene(tableScene, quick)), timeless(expected));
});

test("an object that cannot be aligned leaves the others", async () => {
  const [first, second] = tableScene.objects;
  assert.ok(first && second);
  const empty = { ...second, mask: new Uint8Array(masks[0]?.length ?? 0) };
  const { objects } = await here.alignScene({ ...tableScene, objects: [first, empty] }, quick);
  assert.equal(objects[0]?.error, undefined);
  assert.equal(objects[1]?.error?.code, "EMPTY_MASK");
  assert.equal(objects[1]?.name, second.name);
});

test("errors of a scene name the argument", async () => {
  const [first] = tableScene.objects;
  assert.ok(first);
  const wrong = (scene: object) => () => here.alignScene(scene as SceneInput, quick);
  const { width, height } = tableView;
  const cases: [object, Fault][] = [
    [{ ...tableView, objects: [] }, "INVALID_ARGUMENT objects"],
    [{ ...tableView }, "INVALID_ARGUMENT objects"],
    [{ ...tableScene, depth: undefined }, "INVALID_ARGUMENT depth"],
    [{ ...tableScene, objects: [{ ...first, mask: undefined }] }, "INVALID_ARGUMENT objects[0].mask"],
    [{ ...tableScene, objects: [{ ...first, colour: 1 }] }, "INVALID_ARGUMENT objects[0].colour"],
    [{ ...tableScene, objects: [{ ...first, mask: undefined, label: 1 }] }, "INVALID_ARGUMENT objects[0].label"],
    [
      { ...tableScene, objects: [{ ...first, mask: { data: new Uint8Array(4), width: 2, height: 2 } }] },
      "SIZE_MISMATCH objects[0].mask",
    ],
    [{ ...tableScene, labels: { data: new Uint8Array(4), width: 2, height: 2 } }, "SIZE_MISMATCH labels"],
    [{ ...tableScene, occluders: [new Uint8Array(3)] }, "WRONG_LENGTH occluders[0]"],
    [{ ...tableScene, support: "floor" }, "INVALID_ARGUMENT support"],
    [{ ...tableScene, support: { normal: [0, 0, 0], d: 1 } }, "INVALID_ARGUMENT support.normal"],
  ];
  assert.ok(width * height > 4);
  for (const [scene, fault] of cases) await rejectsWith(wrong(scene), fault);
  const options: [object, Fault][] = [
    [{ preset: "paper" }, "INVALID_OPTION options.preset"],
    [{ initial: poses[0] }, "UNKNOWN_OPTION options.initial"],
    [{ qualty: "fast" }, "UNKNOWN_OPTION options.qualty"],
    [{ scale: -1 }, "INVALID_OPTION options.scale"],
  ];
  for (const [option, fault] of options) await rejectsWith(() => here.alignScene(tableScene, option), fault);
});

test("a scene is exported as one GLB with the support as ground", async () => {
  const glbs = expected.objects.map((_, i) => (i === 0 ? standingMesh : standingGlb));
  const objects = placed(expected).map((transform, i) => ({
    name: transform.name,
    mesh: glbs[i] ?? standingMesh,
    transform,
  }));
  const camera = { fy: tableView.camera.fy, width: tableView.width, height: tableView.height };
  const bytes = exportSceneGlb(objects, { support: expected.support, camera });
  const { totalTriangleCount } = await assertValid(bytes);
  assert.equal(totalTriangleCount, standingMesh.indices.length + 2);
  const json = glbJson(bytes);
  const names = json.nodes.map(({ name }: { name?: string }) => name);
  for (const name of ["object 0", "object 1", "object 2", "camera", "support", "view"]) {
    assert.ok(names.includes(name), name);
  }
  // The view turns the normal of the support to y.
  const view = json.nodes[names.indexOf("view")];
  const { normal, d } = expected.support ?? { normal: [0, 0, 0] as const, d: 0 };
  const foot = transformed([-normal[0] * d, -normal[1] * d, -normal[2] * d, 0, 0, 0], { scale: 1, ...view });
  assert.ok(Math.abs(foot[1] ?? 1) < 1e-9 && Math.abs((foot[4] ?? 0) - d) < 1e-9, `${foot}`);
});
