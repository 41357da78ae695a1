/** The command line with several frames: views and videos. */
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { glb, obj, png, viewFiles } from "../support/files.js";
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
      ...others,
      ...(k < masks ? { "mask.png": mask } : {}),
      ...(poses ? { "pose.json": { camera_to_world: [...rows, [0, 0, 0, 1]] } } : {}),
    });
  }
}

writeFrames("known", [0, 120, 240]);
writeFrames("unknown", [0, 150], { poses: false });
writeFrames("video", [0, 3, 6], { masks: 1 });

const names = ["frame_00", "frame_01", "frame_02"];

test("views with camera poses have a pose in the world and in each frame", () => {
  const { stdout } = succeeds("align known --json known.json");
  assert.match(stdout, /world from mesh/);
  assert.match(stdout, /frame_02.*used.*errors: scale/);
  const { known } = results("known.json");
  assert.ok(Math.abs(known.scale / truth.scale - 1) < 0.02);
  assert.equal(known.rotation.length, 3);
  assert.equal(known.translation.length, 3);
  assert.ok(turnBetween(known.quaternion, truth.rotation) < 3);
  assert.deepEqual(Object.keys(known.frames), names);
  for (const [k, name] of names.entries()) {
    const frame = known.frames[name];
    assert.deepEqual([frame.rotation.length, frame.translation.length, frame.role], [3, 3, "used"]);
    assert.ok(frame.confidence > 0.5 && frame.errors.rotationErrorDeg < 3, name);
    assert.ok(turnBetween(frame.camera.quaternion, frameAt(120 * k).cameraToWorld.rotation) < 1e-3, name);
  }
});

test("views without camera poses have one size, and poses in their frames only", () => {
  const { stdout, stderr } = succeeds("align unknown known --json - --quality fast --no-metrics");
  const { unknown, known } = JSON.parse(stdout);
  assert.ok(Math.abs(unknown.scale / truth.scale - 1) < 0.04);
  assert.equal("rotation" in unknown, false);
  assert.ok(Math.abs(unknown.frames.frame_00.scale / unknown.frames.frame_01.scale - 1) < 1e-9);
  assert.equal("metrics" in known.frames.frame_00, false);
  assert.match(stderr, /case +conf\./);
});

test("a video is tracked from the mask of its first frame", () => {
  const { stdout } = succeeds("track video --json video.json");
  assert.match(stdout, /frame_02 +tracking/);
  const { video } = results("video.json");
  assert.deepEqual(Object.keys(video.frames), names);
  assert.equal(video.scale, video.frames.frame_02.scale);
  for (const [k, name] of names.entries()) {
    const { state, quaternion, confidence } = video.frames[name];
    assert.equal(state, "tracking");
    assert.ok(confidence > 0 && turnBetween(quaternion, frameAt(3 * k).pose.rotation) < 4, name);
  }
});

test("--no-image is an option of cases with frames, too", () => {
  for (const args of [
    ["align", "known", "--quality", "fast"],
    ["track", "video"],
  ]) {
    succeeds(...args, "--no-image");
  }
});

test("the photos of frames are read, and left out with --no-image", () => {
  const box = printedBox();
  writeCase("printed", { "mesh.obj": obj(box.mesh) });
  const turned = [0, 4].map((angle, k) => {
    const { frame, image, pose } = box.frameAt(angle);
    writeCase(`printed/frame_0${k}`, {
      ...viewFiles(frame),
      "rgb.png": png(image.data, frame.width, frame.height, 3),
    });
    return pose;
  });
  const frameOf = (args: string[], json: string) => {
    succeeds(...args, "printed", "--json", json);
    return results(json).printed.frames.frame_00;
  };
  for (const command of ["align", "track"]) {
    const colored = frameOf([command], `${command}-colored.json`);
    assert.ok(turnBetween(colored.quaternion, (turned[0] as { rotation: number[] }).rotation) < 3, command);
    if (command === "align") {
      assert.equal(colored.color.verdict === "agreed" || colored.color.verdict === "decided", true);
      assert.equal(frameOf([command, "--no-image"], "plain.json").color, undefined);
    }
  }
});

test("what fails in a video is told with its file", () => {
  writeCase("spoilt", { "mesh.glb": "no mesh", "frame_00/note.txt": "" });
  const properties = ["code", "argument", "found", "expected", "remedy", "message", "file"];
  const mesh = run("track spoilt --json spoilt.json");
  assert.equal(mesh.status, 1, mesh.stderr);
  const { error } = results("spoilt.json").spoilt;
  assert.deepEqual(Object.keys(error), properties);
  assert.equal(error.argument, "mesh");
  assert.match(error.file, /spoilt.mesh\.glb$/);

  writeFrames("torn", [0, 3]);
  writeFileSync(join(folder, "torn", "frame_01", "depth.npy"), "no depth");
  const frame = run("track torn --json torn.json");
  assert.equal(frame.status, 1, frame.stderr);
  const { frame_00, frame_01 } = results("torn.json").torn.frames;
  assert.equal(frame_00.state, "tracking");
  assert.deepEqual(Object.keys(frame_01.error), properties);
  assert.match(frame_01.error.file, /frame_01.depth\.npy$/);
});

test("wrong usage is told", () => {
  mkdirSync(join(folder, "empty"));
  refusesUsage({
    "track empty": /frame_/,
    "track video --quality nice": /Allowed choices/,
    "align known --preset paper": /several frames/,
    "align known --search local": /search/,
  });
});
