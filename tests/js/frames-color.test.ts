/** Photos of views and of the frames of a video: the print tells the turn that shape leaves open. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { createAligner, type FrameInput, type MeshArrays, type ViewInput } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { printedBox } from "../support/printed-box.js";
import { turnBetween } from "../support/rig.js";

const box = printedBox();
const mesh: MeshArrays = box.mesh;
const plain: MeshArrays = { positions: box.mesh.positions, indices: box.mesh.indices };
const frames = [0, 4, 8].map((degrees) => box.frameAt(degrees));
const [first] = frames as [(typeof frames)[0]];

/** The errors of the rotation in each view, degrees. */
const errors = (poses: readonly { rotation: readonly number[] }[]) =>
  poses.map(({ rotation }, k) => turnBetween(rotation, (frames[k] as typeof first).pose.rotation));

const aligners = await Promise.all([createAligner(), createAligner({ workers: 1 })]);
after(() => {
  for (const aligner of aligners) aligner.dispose();
});

for (const [name, isKnown] of [
  ["known camera poses", true],
  ["unknown camera poses", false],
] as const) {
  test(`views with photos, ${name}`, async () => {
    const views: ViewInput[] = frames.map(({ frame, image, cameraToWorld }) =>
      isKnown ? { ...frame, image, cameraToWorld } : { ...frame, image },
    );
    const results = [];
    for (const aligner of aligners) results.push(await aligner.alignViews({ mesh, views }, { metrics: true }));
    for (const { views, confidence } of results) {
      assert.ok(Math.max(...errors(views)) < 3, String(errors(views)));
      for (const { color, metrics } of views) {
        assert.ok(color !== undefined && color.agreement > 0.6 && (color.margin ?? 0) > 0.1, JSON.stringify(color));
        assert.ok((metrics?.colorAgreement ?? 0) > 0.5);
      }
      assert.ok(confidence > 0.5);
    }
    assert.deepEqual(results[0]?.matrix, results[1]?.matrix, "the same bits in a worker");
    // Without photos, or without colours, shape alone counts.
    const shape = await aligners[0].alignViews({
      mesh: plain,
      views: views.map(({ image: _, ...view }) => view as ViewInput),
    });
    const uncolored = await aligners[0].alignViews({ mesh: plain, views });
    assert.deepEqual(uncolored.matrix, shape.matrix);
    assert.equal(uncolored.views[0]?.color, undefined);
    assert.ok(uncolored.views[0]?.warnings.length !== undefined);
  });
}

test("a video with photos is found the right way round, and stays so", async () => {
  const found = [];
  for (const aligner of aligners) {
    const tracker = await aligner.track(mesh);
    const poses = [];
    for (const { frame, image } of frames) poses.push(await tracker.next({ ...frame, image } as FrameInput));
    tracker.close();
    assert.ok(Math.max(...errors(poses)) < 3, String(errors(poses)));
    found.push(poses.map(({ matrix }) => matrix));
  }
  assert.deepEqual(found[0], found[1], "the same bits in a worker");
});

test("a prepared mesh keeps its colours for views and videos", async () => {
  const [aligner] = aligners;
  const prepared = await aligner.prepareMesh(mesh);
  const views = frames.map(({ frame, image }) => ({ ...frame, image }) as ViewInput);
  const { matrix } = await aligner.alignViews({ mesh: prepared, views });
  assert.deepEqual(matrix, (await aligner.alignViews({ mesh, views })).matrix);
  const tracker = await aligner.track(prepared);
  const { rotation } = await tracker.next(views[0] as FrameInput);
  assert.ok(turnBetween(rotation, first.pose.rotation) < 3);
  tracker.close();
  prepared.dispose();
});

test("a photo of another shape is named", async () => {
  const image = { data: new Uint8Array(3 * 30 * 90), width: 30, height: 90 };
  const [aligner] = aligners;
  const wrong = { ...first.frame, image } as ViewInput;
  await rejectsWith(
    () => aligner.alignViews({ mesh, views: [first.frame as ViewInput, wrong] }),
    "SIZE_MISMATCH views[1].image",
    /field of view/,
  );
  const tracker = await aligner.track(mesh);
  await rejectsWith(() => tracker.next(wrong), "SIZE_MISMATCH image", /field of view/);
  tracker.close();
});
