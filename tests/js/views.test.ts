/** Camera poses in other conventions than this package's are named, and nothing is claimed for them. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, type Sim3, type ViewInput } from "sim3align";
import { compose, invert, toSim3 } from "sim3align/conventions";
import { frameAt } from "../support/rig.js";
import { mesh } from "../support/scene.js";

const aligner = await createAligner();
const flip = toSim3({ scale: 1, rotation: [1, 0, 0, 0], translation: [0, 0, 0] });
const times = (factor: number, { rotation, translation }: Sim3) =>
  toSim3({ scale: 1, rotation, translation: translation.map((x) => factor * x) as [number, number, number] });

const views = [0, 100, 220].map((angle): ViewInput => {
  const { frame, cameraToWorld } = frameAt(angle);
  return { ...frame, cameraToWorld };
});

const conventions: Record<string, { write: (pose: Sim3) => Sim3; named: RegExp | null }> = {
  "this package's": { write: (pose) => pose, named: null },
  "OpenGL's axes": { write: (pose) => compose(pose, flip), named: /poses have the axes of OpenGL/ },
  "world-to-camera": { write: invert, named: /poses are world-to-camera \(extrinsics\)/ },
  "millimetres, OpenGL's axes": {
    write: (pose) => times(1000, compose(pose, flip)),
    named: /poses are in millimetres: .* have the axes of OpenGL/,
  },
};

for (const [name, { write, named }] of Object.entries(conventions)) {
  test(`camera poses: ${name}`, async () => {
    const written = views.map((view) => ({ ...view, cameraToWorld: write(toSim3(view.cameraToWorld as Sim3)) }));
    const found = await aligner.alignViews({ mesh, views: written }, { quality: "fast", metrics: false });
    const message = found.warnings.find(({ code }) => code === "VIEW_CONTRADICTS")?.message;
    if (named === null) {
      assert.equal(message, undefined);
      assert.ok(found.confidence > 0.8);
      return;
    }
    assert.match(message ?? "", named);
    assert.ok(found.confidence <= 0.5, `${found.confidence}`);
    for (const { role, confidence } of found.views) assert.ok(role === "used" || confidence === 0);
  });
}
