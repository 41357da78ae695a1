/** The command line with several frames: views and videos. */
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder, results, run } from "../support/command-line.js";
import { glb, npy, obj, png } from "../support/files.js";
import { printedBox } from "../support/printed-box.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { mesh, rotationRows, truth } from "../support/scene.js";

/** Writes a case of frames at these angles, degrees. */
function writeFrames(name: string, angles: readonly number[], { poses = true, masks = angles.length } = {}): void {
  mkdirSync(join(folder, name));
  writeFileSync(join(folder, name, "mesh.glb"), glb(mesh));
  angles.forEach((angle, k) => {
    const { frame, cameraToWorld, pose } = frameAt(angle);
    const path = join(folder, name, `frame_${String(k).padStart(2, "0")}`);
    mkdirSync(path);
    const write = (file: string, content: Uint8Array | string) => writeFileSync(join(path, file), content);
    write("depth.npy", npy(frame.depth, frame.height, frame.width));
    write("camera.json", JSON.stringify(frame.camera));
    if (k < masks)
      write(
        "mask.png",
        png(
          frame.mask.map((m) => 255 * m),
          frame.width,
          frame.height,
        ),
      );
    const { rotation, translation } = cameraToWorld;
    const rows = rotationRows(rotation).map((row, i) => [...row, translation[i]]);
    if (poses) write("pose.json", JSON.stringify({ camera_to_world: [...rows, [0, 0, 0, 1]] }));
    const known = { available: true, scale: pose.scale, rotation: rotationRows(pose.rotation) };
    write("gt.json", JSON.stringify({ ...known, translation: pose.translation, symmetry: "none" }));
  });
}

writeFrames("known", [0, 120, 240]);
writeFrames("unknown", [0, 150], { poses: false });
writeFrames("video", [0, 3, 6], { masks: 1 });

const names = ["frame_00", "frame_01", "frame_02"];

test("views with camera poses have a pose in the world and in each frame", () => {
  const { status, stdout, stderr } = run("align", "known", "--json", "known.json");
  assert.equal(status, 0, stderr);
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
  const { status, stdout, stderr } = run(
    "align",
    "unknown",
    "known",
    "--json",
    "-",
    "--quality",
    "fast",
    "--no-metrics",
  );
  assert.equal(status, 0, stderr);
  const { unknown, known } = JSON.parse(stdout);
  assert.ok(Math.abs(unknown.scale / truth.scale - 1) < 0.04);
  assert.equal("rotation" in unknown, false);
  assert.ok(Math.abs(unknown.frames.frame_00.scale / unknown.frames.frame_01.scale - 1) < 1e-9);
  assert.equal("metrics" in known.frames.frame_00, false);
  assert.match(stderr, /case +conf\./);
});

test("a video is tracked from the mask of its first frame", () => {
  const { status, stdout, stderr } = run("track", "video", "--json", "video.json");
  assert.equal(status, 0, stderr);
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
    const { status, stderr } = run(...args, "--no-image");
    assert.equal(status, 0, stderr);
  }
});

test("the photos of frames are read, and left out with --no-image", () => {
  const box = printedBox();
  mkdirSync(join(folder, "printed"));
  writeFileSync(join(folder, "printed", "mesh.obj"), obj(box.mesh));
  const turned = [0, 4].map((angle, k) => {
    const { frame, image, pose } = box.frameAt(angle);
    const path = join(folder, "printed", `frame_0${k}`);
    mkdirSync(path);
    writeFileSync(join(path, "depth.npy"), npy(frame.depth, frame.height, frame.width));
    writeFileSync(join(path, "camera.json"), JSON.stringify(frame.camera));
    const white = frame.mask.map((m) => 255 * m);
    writeFileSync(join(path, "mask.png"), png(white, frame.width, frame.height));
    writeFileSync(join(path, "rgb.png"), png(image.data, frame.width, frame.height, 3));
    return pose;
  });
  const frameOf = (args: string[], json: string) => {
    const { status, stderr } = run(...args, "printed", "--json", json);
    assert.equal(status, 0, stderr);
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
  mkdirSync(join(folder, "spoilt"));
  writeFileSync(join(folder, "spoilt", "mesh.glb"), "no mesh");
  mkdirSync(join(folder, "spoilt", "frame_00"));
  const properties = ["code", "argument", "found", "expected", "remedy", "message", "file"];
  const mesh = run("track", "spoilt", "--json", "spoilt.json");
  assert.equal(mesh.status, 1, mesh.stderr);
  const { error } = results("spoilt.json").spoilt;
  assert.deepEqual(Object.keys(error), properties);
  assert.equal(error.argument, "mesh");
  assert.match(error.file, /spoilt.mesh\.glb$/);

  writeFrames("torn", [0, 3]);
  writeFileSync(join(folder, "torn", "frame_01", "depth.npy"), "no depth");
  const frame = run("track", "torn", "--json", "torn.json");
  assert.equal(frame.status, 1, frame.stderr);
  const { frame_00, frame_01 } = results("torn.json").torn.frames;
  assert.equal(frame_00.state, "tracking");
  assert.deepEqual(Object.keys(frame_01.error), properties);
  assert.match(frame_01.error.file, /frame_01.depth\.npy$/);
});

test("wrong usage is told", () => {
  mkdirSync(join(folder, "empty"));
  for (const [args, pattern] of [
    [["track", "empty"], /frame_/],
    [["track", "video", "--quality", "nice"], /Allowed choices/],
    [["align", "known", "--preset", "paper"], /several frames/],
    [["align", "known", "--search", "local"], /search/],
  ] as const) {
    const { status, stderr } = run(...args);
    assert.equal(status, 2, args.join(" "));
    assert.match(stderr, pattern);
  }
});
