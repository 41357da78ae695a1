/** The command line with several frames: views and videos. */
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder, read, results, run, succeeds, writeCase } from "../support/command-line.js";
import { type Files, glb, obj, png, viewFiles } from "../support/files.js";
import { printedBox } from "../support/printed-box.js";
import { frameAt, frameFiles, turnBetween } from "../support/rig.js";
import { mesh, rotationRows, truth } from "../support/scene.js";

/** Writes a case of frames at these angles, degrees. */
function writeFrames(name: string, angles: readonly number[], { poses = true, masks = angles.length } = {}): void {
  writeCase(name, { "mesh.glb": glb(mesh) });
  for (const [k, angle] of angles.entries()) {
    const seen = frameAt(angle);
    const { "mask.png": mask, ...others } = frameFiles(seen);
    const { rotation, translation } = seen.cameraToWorld;
    const rows = rotationRows(rotation).map((row, i) => [...row, translation[i]]);
    writeCase(`${name}/frame_0${k}`, {
      ...{ ...others, ...(k < masks ? { "mask.png": mask } : {}) },
      ...(poses ? { "pose.json": { camera_to_world: [...rows, [0, 0, 0, 1]] } } : {}),
    });
  }
}

writeFrames("known", [0, 120, 240]);
writeFrames("unknown", [0, 150], { poses: false });
writeFrames("video", [0, 3, 6], { masks: 1 });
const names = ["frame_00", "frame_01", "frame_02"];

test("views with camera poses have a pose in the world and in each frame, which evaluate scores", () => {
  const { stdout } = succeeds("align known --json known.json");
  assert.match(stdout, /world from mesh.*frame_02.*used.*errors: scale/s);
  const { known } = results("known.json");
  assert.ok(Math.abs(known.scale / truth.scale - 1) < 0.02 && turnBetween(known.rotation, truth.rotation) < 3);
  assert.equal(known.views.length, names.length);
  for (const [k, expected] of names.entries()) {
    const { name, rotation, translation, role, confidence, errors, camera } = known.views[k];
    assert.deepEqual([name, rotation.length, translation.length, role], [expected, 4, 3, "used"]);
    assert.ok(confidence > 0.5 && errors.rotationErrorDeg < 3, name);
    assert.ok(turnBetween(camera.rotation, frameAt(120 * k).cameraToWorld.rotation) < 1e-3, name);
  }
  assert.match(succeeds("evaluate known --transform known.json --json e.json").stdout, /known\/frame_01: evaluation/);
  for (const [k, name] of names.entries()) {
    const { metrics, errors } = results("e.json").known.frames[name];
    assert.ok(metrics.iou > 0.8 && Math.abs(errors.scaleError - known.views[k].errors.scaleError) < 1e-9, name);
  }
});

test("views without camera poses have one size; a table has a row for each case", () => {
  const flags = "--json - --csv views.csv --quality fast --no-metrics --no-image";
  const { stdout, stderr } = succeeds(`align unknown known ${flags}`);
  const { unknown, known } = JSON.parse(stdout);
  assert.ok(Math.abs(unknown.scale / truth.scale - 1) < 0.04 && unknown.world !== "given");
  assert.ok(Math.abs(unknown.views[0].scale / unknown.views[1].scale - 1) < 1e-9);
  assert.equal("metrics" in known.views[0], false);
  assert.match(stderr, /case +conf\./);
  assert.deepEqual(read("views.csv").match(/^\w+/gm)?.sort(), ["case", "known", "unknown"]);
});

test("a video is tracked from the mask of its first frame; its record is resumed", () => {
  const flags = "--json video.json --jsonl v.jsonl --csv v.csv";
  assert.match(succeeds(`track video ${flags}`).stdout, /frame_02 +tracking/);
  const { video } = results("video.json");
  assert.deepEqual(Object.keys(video.frames), names);
  for (const [k, name] of names.entries()) {
    const { state, rotation, confidence } = video.frames[name];
    assert.ok(state === "tracking" && confidence > 0, name);
    assert.ok(turnBetween(rotation, frameAt(3 * k).pose.rotation) < 4, name);
  }
  assert.deepEqual(read("v.csv").match(/(?<=^video\/)\w+/gm), names);
  assert.match(succeeds(`track video ${flags} --resume`).stderr, /resumed: 1 of 1/);
});

test("the photos of frames are read, and left out with --no-image", () => {
  const box = printedBox();
  writeCase("printed", { "mesh.obj": obj(box.mesh) });
  const turned = [0, 4].map((angle, k) => {
    const { frame, image, pose } = box.frameAt(angle);
    const photo = png(image.data, frame.width, frame.height, 3);
    writeCase(`printed/frame_0${k}`, { ...viewFiles(frame), "rgb.png": photo });
    return pose;
  });
  const frameOf = (words: string) => {
    succeeds(`${words} printed --json photos.json`);
    const { views, frames } = results("photos.json").printed;
    return views === undefined ? frames.frame_00 : views[0];
  };
  const [aligned, tracked] = [frameOf("align"), frameOf("track")];
  for (const { rotation } of [aligned, tracked]) assert.ok(turnBetween(rotation, turned[0]?.rotation ?? []) < 3);
  assert.match(aligned.color.verdict, /^(agreed|decided)$/);
  assert.equal(frameOf("align --quality fast --no-image").color, undefined);
});

test("check says of views what align says: without camera poses, each needs a mask", () => {
  writeFrames("unmasked", [0, 3], { poses: false, masks: 1 });
  const [checked, aligned] = ["check", "align"].map((command) => {
    assert.equal(run(`${command} unmasked --json said.json`).status, 1, command);
    return results("said.json").unmasked.error;
  });
  assert.deepEqual(checked, aligned);
  succeeds("check known video unknown");
});

test("what fails in a video is reported with its file", () => {
  writeCase("spoilt", { "mesh.glb": "no mesh", "frame_00/note.txt": "" });
  writeFrames("torn", [0, 3]);
  writeFileSync(join(folder, "torn", "frame_01", "depth.npy"), "no depth");
  assert.equal(run("track spoilt torn --json failed.json").status, 1);
  const { spoilt, torn } = results("failed.json");
  const properties = ["code", "argument", "found", "expected", "remedy", "message", "file"];
  for (const { error } of [spoilt, torn.frames.frame_01]) assert.deepEqual(Object.keys(error), properties);
  assert.match(spoilt.error.file, /spoilt.mesh\.glb$/);
  assert.match(torn.frames.frame_01.error.file, /frame_01.depth\.npy$/);
  assert.equal(torn.frames.frame_00.state, "tracking");
});

test("frames are in the order of their numbers; a camera beside them is that of the frames without one", () => {
  const numbers = [1, 2, 9, 10, 11];
  writeCase("numbers", {
    "mesh.glb": glb(mesh),
    "camera.json": frameFiles(frameAt(0))["camera.json"],
    "notes.txt": "",
  });
  for (const [k, number] of numbers.entries()) {
    const { "camera.json": _, ...others } = frameFiles(frameAt(k));
    writeCase(`numbers/frame_${number}`, others);
  }
  const { stdout } = succeeds("track numbers --json numbers.json");
  const { frames, inputs, unread } = results("numbers.json").numbers;
  assert.deepEqual(
    Object.keys(frames),
    numbers.map((number) => `frame_${number}`),
  );
  assert.deepEqual(frames.frame_10.inputs["../camera.json"], { as: "camera" });
  assert.equal("cameraSource" in frames.frame_10, false);
  assert.deepEqual([Object.keys(inputs), unread], [["mesh.glb", "camera.json"], ["notes.txt"]]);
  assert.match(stdout, /not read: notes\.txt\n/);
});

test("a folder in FoundationPose's layout is a video, and a case of its frames with masks", () => {
  const columns = [0, 3].map((angle, k) => {
    const { "depth.npy": depth, "mask.png": mask, "camera.json": camera } = frameFiles(frameAt(angle)) as Files;
    const { fx, fy, cx, cy } = camera as Record<string, number>;
    return {
      ...{ [`depth/170${k}.npy`]: depth, "cam_K.txt": `${fx} 0 ${cx}\n0 ${fy} ${cy}\n0 0 1\n` },
      ...(k === 0 ? { [`masks/170${k}.png`]: mask } : {}),
    };
  });
  writeCase("foundation", { ...columns[0], ...columns[1], "mesh/any_name.obj": obj(mesh), "notes/a.txt": "" });
  assert.match(succeeds("align foundation --json aligned.json").stdout, /not read: notes\//);
  const { scale, rotation, translation, inputs } = results("aligned.json").foundation;
  assert.ok(Math.abs(scale / truth.scale - 1) < 0.02 && turnBetween(rotation, truth.rotation) < 3);
  assert.equal(inputs["mesh/any_name.obj"].as, "mesh");
  assert.match(succeeds("track foundation").stdout, /1700 +tracking.*\n1701 +tracking/);

  const rows = rotationRows(rotation).map((row, i) => [...row.map((x) => scale * x), translation[i]].join(" "));
  writeFileSync(join(folder, "pose.txt"), `${rows.join("\n")}\n0 0 0 1\n`);
  succeeds("evaluate foundation --transform pose.txt --json scores.json");
  assert.ok(results("scores.json").foundation.frames["1700"].metrics.iou > 0.8);
});
