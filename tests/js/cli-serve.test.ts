/** The process that stays: requests and answers, and the Python of the guide. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { chmodSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { delimiter, join } from "node:path";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { files, folder, writeCase } from "../support/command-line.js";
import { commandLine, repository } from "../support/environment.js";
import { withoutTimes } from "../support/results.js";
import { mesh, view } from "../support/scene.js";
import { tableFiles } from "../support/table.js";

writeCase("cases/blob", files);
writeCase("table", tableFiles());
const { "depth.npy": depthFile, "mask.png": maskFile, "mesh.glb": meshFile, "camera.json": cameraFile } = files;
const inColumns = {
  "mesh/blob.glb": meshFile,
  "camera.json": cameraFile,
  "depth/0.npy": depthFile,
  "masks/0.png": maskFile,
};
writeCase("columns", { ...inColumns, "depth/1.npy": depthFile });
writeCase("masked", { ...inColumns, "depth/1.npy": depthFile, "masks/1.png": maskFile });
const { width, height, depth, mask, camera } = view;
const options = { quality: "fast", seed: 3 } as const;
const inline = (array: Float32Array | Uint8Array | Uint32Array, shape?: number[]) => ({
  base64: Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString("base64"),
  dtype: array.constructor.name.replace("Array", "").toLowerCase(),
  shape,
});

function served(lines: readonly (object | string)[], expectedStatus = 0) {
  const input = lines.map((line) => (typeof line === "string" ? line : JSON.stringify(line))).join("\n");
  const { status, stdout } = spawnSync(process.execPath, [commandLine, "serve", "--workers", "2"], {
    ...{ cwd: folder, input, encoding: "utf8", maxBuffer: 1 << 26 },
  });
  assert.equal(status, expectedStatus);
  const answers = stdout
    .trimEnd()
    .split("\n")
    .map((line) => JSON.parse(line));
  return new Map(answers.map(({ id, ...answer }) => [id, answer]));
}

test("a folder, files and arrays have the result of align; each line has an answer", async () => {
  const arrays = {
    depth: inline(depth, [height, width]),
    mask: inline(mask, [height, width]),
    mesh: { positions: inline(mesh.positions), indices: inline(mesh.indices) },
    camera,
  };
  const points = Float32Array.from({ length: 3 * width * height }, (_, i) => {
    const [k, axis] = [Math.floor(i / 3), i % 3];
    const z = depth[k] ?? 0;
    const [x, y] = [((k % width) - camera.cx) / camera.fx, (Math.floor(k / width) - camera.cy) / camera.fy];
    return [x * z, y * z, z][axis] ?? 0;
  });
  const paths = { depth: "depth.npy", mask: "mask.png", mesh: "mesh.glb", camera: "camera.json" };
  const inFolder = Object.fromEntries(Object.entries(paths).map(([part, name]) => [part, `cases/blob/${name}`]));
  const answers = served(
    [
      { id: "folder", case: "cases/blob", options },
      { id: "one frame with a mask", case: "columns", options },
      { id: "files", ...inFolder, options },
      { id: "bytes", ...inFolder, mask: { base64: Buffer.from(files["mask.png"]).toString("base64") }, options },
      { id: "arrays", ...arrays, options },
      { id: "camera file", ...inFolder, camera: undefined, cameraFile: inFolder.camera, options },
      {
        id: "points",
        ...arrays,
        depth: undefined,
        camera: undefined,
        pointMap: inline(points, [height, width, 3]),
        options,
      },
      ...["", "no JSON", { case: "nowhere" }, { case: "cases/blob", quality: "fast" }, { case: "cases/blob", camera }],
      { id: "option", case: "cases/blob", options: { quality: "none" } },
      { id: "width", case: "cases/blob", width },
      { id: "number", case: 5 },
      { id: "scene", case: "table" },
      { id: "frames", case: "masked" },
      { id: "two cameras", ...inFolder, cameraFile: inFolder.camera },
    ],
    1,
  );
  const aligner = await createAligner();
  const expected = await aligner.align({ depth, width, height, mask, mesh, camera }, options);
  for (const id of ["folder", "one frame with a mask", "files", "bytes", "arrays", "camera file"]) {
    const { depthUnit: _, maskReading: __, ...found } = answers.get(id).result;
    const { depthUnit: ___, ...own } = JSON.parse(JSON.stringify(expected));
    assert.deepEqual(withoutTimes(found), withoutTimes(own), id);
  }
  assert.ok(Math.abs(answers.get("points").result.scale / expected.scale - 1) < 0.01);
  const codes = {
    7: "INVALID_ARGUMENT",
    8: "FILE_NOT_FOUND",
    9: "INVALID_ARGUMENT",
    10: "INVALID_ARGUMENT",
    option: "INVALID_OPTION",
    width: "INVALID_ARGUMENT",
    number: "INVALID_ARGUMENT",
    "two cameras": "INVALID_ARGUMENT",
    scene: "INVALID_ARGUMENT",
    frames: "INVALID_ARGUMENT",
  };
  for (const [id, code] of Object.entries(codes)) {
    assert.equal(answers.get(Number.isNaN(Number(id)) ? id : Number(id)).error.code, code, id);
  }
  const messages = {
    10: /found a case beside camera,/,
    scene: /found a scene at table.*"sim3align scene"/,
    frames: /found 2 frames at masked.*"sim3align align".*"sim3align track"/,
  };
  for (const [id, message] of Object.entries(messages)) {
    assert.match(answers.get(id === "10" ? 10 : id).error.message, message);
  }
});

const hasPython = spawnSync("python3", ["--version"]).status === 0;

test("the Python of the guide aligns many cases", { skip: !hasPython && "no python3" }, () => {
  const guide = readFileSync(join(repository, "docs", "guides", "batches.md"), "utf8");
  const [, program] = /^```python\n((?:(?!```)[\s\S])*class Aligner[\s\S]*?)^```$/m.exec(guide) ?? [];
  const bin = join(folder, "bin");
  mkdirSync(bin, { recursive: true });
  writeFileSync(join(bin, "npx"), `#!/bin/sh\nshift\nexec "${process.execPath}" "${commandLine}" "$@"\n`);
  chmodSync(join(bin, "npx"), 0o755);
  const use = `
aligner = Aligner("--workers", "2")
requests = ({"id": i, "case": "cases/blob", "options": {"quality": "fast"}} for i in range(40))
answers = list(aligner.align_all(requests))
print(len(answers), sorted(a["id"] for a in answers) == list(range(40)), len(set(a["result"]["scale"] for a in answers)))
try:
    aligner.align(case="nowhere")
except ValueError as error:
    print(error)
aligner.close()
`;
  const env = { ...process.env, PATH: [bin, process.env.PATH].join(delimiter) };
  const { stdout, stderr } = spawnSync("python3", ["-c", `${program}${use}`], { cwd: folder, env, encoding: "utf8" });
  assert.match(stdout, /^40 True 1\ncase: found nothing to read at nowhere/, stderr);
});
