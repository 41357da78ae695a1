/** The examples that run in Node. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { type Alignment, createAligner, type Sim3, type Sim3Like } from "sim3align";
import { compose, fromBop, fromFrame, invert, toSim3 } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";
import { repository, sampleDir } from "../support/environment.js";
import { examplesDir, filesOf, newFolder, printedBy, runExample, writeCase } from "../support/examples.js";
import { greyJpeg, tiff } from "../support/exif.js";
import { turnBetween } from "../support/rig.js";
import { otherPose } from "../support/scene.js";

const aligner = await createAligner();

const sample = filesOf(sampleDir);
const gt = JSON.parse(readFileSync(join(sampleDir, "gt.json"), "utf8"));
const truth = { scale: gt.scale, rotation: gt.rotation, translation: gt.translation };

/** The longest side of the bounding box of points. */
function longestExtent(positions: Float32Array): number {
  const sides = [0, 1, 2].map((axis) => {
    const values = positions.filter((_, i) => i % 3 === axis);
    return values.reduce((a, b) => Math.max(a, b)) - values.reduce((a, b) => Math.min(a, b));
  });
  return Math.max(...sides);
}

/** Checks a pose of the sample against what is known of it. */
async function isRight(matrix: number[]): Promise<void> {
  const { errors } = await aligner.evaluate(sample, { matrix }, { truth });
  assert.ok(errors !== null);
  assert.ok(errors.scaleError < 0.05 && errors.translationErrorRelative < 0.05, JSON.stringify(errors));
  assert.ok(errors.rotationErrorDeg < 10, JSON.stringify(errors));
}

test("the compiler finds nothing wrong in the examples", () => {
  const tsc = join(repository, "node_modules", "typescript", "bin", "tsc");
  const { stdout } = spawnSync(process.execPath, [tsc, "--project", examplesDir], { encoding: "utf8" });
  assert.equal(stdout, "");
});

test("01-one-call prints the transform of a case folder", async () => {
  const printed = JSON.parse(await printedBy("01-one-call/align.mjs", [sampleDir]));
  const direct = await aligner.align(sample);
  assert.deepEqual(printed.matrix, [...direct.matrix]);
  assert.equal(printed.confidence, direct.confidence);
  await isRight(printed.matrix);
});

test("04-worker-pool-batch writes a table and all results, in order, and goes on after a case at fault", async () => {
  const parent = newFolder();
  const folders = [0, 1, 2].map((i) => writeCase(parent, `case-${i}`, { pose: otherPose(i) }));
  folders.splice(1, 0, writeCase(parent, "at-fault", { isEmpty: true }));
  const out = join(parent, "results");
  const { status, stderr } = await runExample("04-worker-pool-batch/batch.mjs", [
    ...folders,
    ...["--out", out, "--workers", "2"],
  ]);
  assert.equal(status, 1, stderr);

  const [header = "", ...lines] = readFileSync(`${out}.csv`, "utf8").trim().split("\n");
  const columns = header.split(",");
  const rows = lines.map((line) => new Map(line.split(",").map((cell, i) => [columns[i] ?? "", cell])));
  assert.deepEqual(
    rows.map((row) => [row.get("case"), row.get("error")]),
    [
      ["case-0", ""],
      ["at-fault", "EMPTY_MASK"],
      ["case-1", ""],
      ["case-2", ""],
    ],
  );
  const records = JSON.parse(readFileSync(`${out}.json`, "utf8"));
  for (const [i, folder] of folders.entries()) {
    assert.equal(records[i].folder, folder);
    if (i === 1) continue;
    const direct = await aligner.align(filesOf(folder));
    assert.deepEqual(records[i].matrix, [...direct.matrix]);
    assert.equal(Number(rows[i]?.get("scale")), direct.scale);
    assert.equal(Number(rows[i]?.get("confidence")), direct.confidence);
  }
});

test("05-annotation-loop brings a dragged object back, keeps the known size, and exports it", async () => {
  const out = join(newFolder(), "annotation");
  const stdout = await printedBy("05-annotation-loop/annotate.mjs", [sampleDir, out]);
  assert.match(stdout, /proposal turned by 0°/);

  const { poses, sizeM, knownExtentM, modelMmPerUnit } = JSON.parse(readFileSync(join(out, "annotation.json"), "utf8"));
  const [dragged, refined, locked] = poses as number[][];
  await assert.rejects(isRight(dragged ?? []), "what was dragged is off");
  await isRight(refined ?? []);
  await isRight(locked ?? []);
  assert.ok(Math.abs(sizeM[1] - knownExtentM) < 1e-6, `${sizeM}`);

  const { 0: [entry] = [] } = JSON.parse(readFileSync(join(out, "scene_gt.json"), "utf8"));
  const fromEntry = fromBop(entry, { scale: modelMmPerUnit / 1000 });
  for (const [i, x] of fromEntry.matrix.entries()) assert.ok(Math.abs(x - (locked?.[i] ?? 0)) < 1e-9);

  // The GLB is in OpenGL's frame.
  const placed = { ...sample, mesh: readFileSync(join(out, "placed.glb")) };
  const still = fromFrame({ scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] }, "opengl");
  const iou = async (input: typeof sample, pose: Sim3Like) => (await aligner.evaluate(input, pose)).metrics.iou ?? -1;
  const [drawn, expected] = [await iou(placed, still), await iou(sample, { matrix: locked ?? [] })];
  assert.ok(Math.abs(drawn - expected) < 1e-3, `${drawn}, not ${expected}`);
});

test("08-two-cameras finds the object in the world, and the cameras from the object", async () => {
  const stdout = await printedBy("08-two-cameras/align-views.mjs");
  const { alone, known, oneMask, unknown } = JSON.parse(stdout);
  const { cameras, frames, mesh, truth } = await import(join(examplesDir, "08-two-cameras", "table.mjs"));
  assert.deepEqual([known.world, oneMask.world, unknown.world], ["given", "given", "camera"]);
  for (const [name, { poses }] of Object.entries({ alone, known, oneMask, unknown } as Record<string, typeof known>)) {
    assert.equal(poses.length, name === "alone" ? 1 : 2);
    for (const [k, pose] of poses.entries()) {
      const inCamera = compose(invert({ matrix: cameras[k] }), { matrix: truth });
      const { errors } = await aligner.evaluate({ mesh, ...frames[k] }, pose, { truth: inCamera });
      const what = `${name}, camera ${k}: ${JSON.stringify(errors)}`;
      assert.ok(errors !== null && errors.rotationErrorDeg < 3 && errors.scaleError < 0.02, what);
      assert.ok(errors.translationErrorM < 0.002, what);
    }
  }
  assert.ok(turnBetween(known.pose.rotation, toSim3({ matrix: truth }).rotation) < 3, JSON.stringify(known.pose));
  const second = compose(invert({ matrix: cameras[0] }), { matrix: cameras[1] });
  const { rotation, translation, rotationSdDeg, positionSdM } = unknown.secondCamera;
  assert.ok(turnBetween(rotation, second.rotation) < 3);
  assert.ok(Math.hypot(...translation.map((x: number, i: number) => x - (second.translation[i] ?? 0))) < 0.03);
  assert.ok(rotationSdDeg > 0 && rotationSdDeg < 5 && positionSdM > 0 && positionSdM < 0.05);
});

test("09-video-annotation tracks from one mask, and a correction reaches the frames before and after it", async () => {
  const out = join(newFolder(), "annotations");
  const stdout = await printedBy("09-video-annotation/annotate-video.mjs", [out]);
  assert.match(stdout, /40 frames, 21 of them corrected/);
  const { FRAMES, frameAt, mesh } = await import(join(examplesDir, "09-video-annotation", "video.mjs"));
  const annotated = Array.from({ length: FRAMES }, (_, k) =>
    JSON.parse(readFileSync(join(out, `frame_${String(k).padStart(2, "0")}.json`), "utf8")),
  );
  assert.deepEqual(JSON.parse(readFileSync(join(out, "poses.json"), "utf8")), annotated.map(poseOf));

  for (const [k, annotation] of annotated.entries()) {
    const { truth: inCamera, ...frame } = frameAt(k);
    assert.deepEqual([annotation.frame, annotation.state, annotation.isCorrected], [k, "tracking", k <= 20]);
    const { errors } = await aligner.evaluate({ mesh, ...frame }, poseOf(annotation), { truth: inCamera });
    assert.ok(errors !== null && errors.rotationErrorDeg < 5, `frame ${k}: ${JSON.stringify(errors)}`);
    assert.ok(errors.translationErrorM < 0.005 && errors.scaleError < 0.02, `frame ${k}: ${JSON.stringify(errors)}`);
    if (k === 20) assert.ok(errors.scaleError < 1e-9, "the corrected frame has the annotator's pose");
  }
});

const poseOf = ({ scale, rotation, translation }: Sim3) => ({ scale, rotation, translation });

test("06-transformersjs aligns a photo without a camera, with the tensors of a relative depth model and of SAM", async () => {
  const { alignTensors } = await import(join(examplesDir, "06-transformersjs", "align-tensors.mjs"));
  const { loadSampleModels } = await import(join(examplesDir, "06-transformersjs", "sample-models.mjs"));
  const see = await loadSampleModels(async (name: string) => readFileSync(join(sampleDir, name)));
  const found = await see();
  // As transformers.js' `Tensor`, none of whose properties is its object's.
  const wrapped = (type: string, { data, dims }: { data: Float32Array; dims: number[] }) =>
    Object.create({ type, data, dims });
  const tensors = {
    ...found,
    predicted_depth: wrapped("float32", found.predicted_depth),
    masks: wrapped("bool", found.masks),
    iou_scores: wrapped("float32", found.iou_scores),
  };
  const [height = 0, width = 0] = found.predicted_depth.dims;
  // 32 mm on full frame.
  const photo = greyJpeg(tiff({}, { focal35: 32, pixelX: width, pixelY: height }, true), width, height);

  const relative: Alignment = await alignTensors(aligner, tensors, photo, sample.mesh);
  assert.equal(relative.depthCalibration?.isMetric, false);
  assert.match(relative.cameraSource ?? "", /^EXIF: 32 mm/);
  const { positions } = await readMesh(sample.mesh);
  const options = { knownExtentM: longestExtent(positions) * truth.scale };
  const metric: Alignment = await alignTensors(aligner, tensors, photo, sample.mesh, options);
  assert.equal(metric.depthCalibration?.isMetric, true);
  const { errors } = await aligner.evaluate(sample, metric, { truth });
  assert.ok(errors !== null && errors.scaleError < 1e-3 && errors.rotationErrorDeg < 10, JSON.stringify(errors));
  // The shift of the depth is known by the relief of the object alone.
  assert.ok(Math.abs(metric.translation[2] / truth.translation[2] - 1) < 0.15, `${metric.translation}`);

  const { depthKind, predicted_depth } = found;
  const depth = { data: predicted_depth.data, width, height };
  const direct = await aligner.align({ depth, depthKind, image: photo, mask: sample.mask, mesh: sample.mesh }, options);
  assert.deepEqual(metric.matrix, direct.matrix);
});
