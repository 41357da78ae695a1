/** Meshes that exporters have mirrored, or whose textures are upside down, are named; right ones are not. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type AlignInput, createAligner } from "sim3align";
import { codesOf } from "../support/errors.js";
import { glbOf, gltfBuffer, gltfJson } from "../support/files.js";
import { printedBox } from "../support/printed-box.js";
import { input, mesh } from "../support/scene.js";

const aligner = await createAligner();
const codes = async (of: AlignInput) => codesOf((await aligner.align(of, { quality: "fast" })).warnings);

test("a mesh that is mirrored is named", async () => {
  const positions = mesh.positions.map((x, i) => (i % 3 === 0 ? -x : x));
  const indices = mesh.indices.map((_, i, all) => all[i + ([0, 1, -1][i % 3] ?? 0)] ?? 0);
  for (const [shape, isNamed] of [
    [mesh, false],
    [{ positions, indices }, true],
  ] as const) {
    assert.equal((await codes({ ...input, mesh: shape })).includes("MESH_LOOKS_MIRRORED"), isNamed);
  }
});

test("depth that continues the plane around the mask is named", async () => {
  // A table below the camera, with the object on it or seen through.
  const table = (i: number) => 1 / (0.9 + 0.006 * Math.floor(i / input.width));
  const { depth: seen } = input;
  const depthOf = (isSeenThrough: boolean) =>
    Float32Array.from(seen, (z, i) => (z > 0 && !isSeenThrough ? z : table(i) * (1 + 0.001 * Math.sin(i * i))));
  for (const isSeenThrough of [false, true]) {
    const found = await codes({ ...input, depth: depthOf(isSeenThrough) });
    assert.equal(found.includes("DEPTH_LOOKS_LIKE_BACKGROUND"), isSeenThrough);
  }
});

test("depth that is inverted is named; that of an object among taller ones is not", async () => {
  const { depth: seen, mask } = input;
  // Noise, so that the pose is not beyond doubt: otherwise, nothing is looked at.
  const noisy = (z: number, i: number) => z * (1 + 0.02 * Math.sin(i * i));
  const among = Float32Array.from(seen, (z, i) => (mask[i] !== 0 ? noisy(z, i) : 0.3));
  const inverted = Float32Array.from(seen, (z, i) => (mask[i] !== 0 ? noisy(1 / z, i) : 0.3));
  for (const [depth, isNamed] of [
    [among, false],
    [inverted, true],
  ] as const) {
    const { shapeConfidence, warnings } = await aligner.align({ ...input, depth }, { quality: "fast" });
    assert.ok(shapeConfidence < 0.8, `${shapeConfidence}`);
    assert.equal(codesOf(warnings).includes("DEPTH_LOOKS_INVERTED"), isNamed);
  }
});

test("an abort at any time ends the call, also during the second look", async () => {
  const positions = mesh.positions.map((x, i) => (i % 3 === 0 ? -x : x));
  const ofMirrored = { ...input, mesh: { ...mesh, positions } };
  for (let last = 1; ; last += 3) {
    let count = 0;
    const { signal } = new AbortController();
    Object.defineProperty(signal, "aborted", { get: () => ++count > last });
    Object.defineProperty(signal, "reason", { value: "over" });
    const outcome = await aligner.align(ofMirrored, { quality: "fast", signal }).then(
      () => "done",
      (error) => error,
    );
    assert.equal(outcome, count > last ? "over" : "done", `${count} checks, aborted after ${last}`);
    if (outcome === "done") return;
  }
});

test("textures that are upside down are named if the photo agrees with them turned", async () => {
  const { mesh: box, frameAt } = printedBox();
  const { frame, image } = frameAt(35);
  const { positions, indices, colors: right } = box;
  const normals = positions.map((_, i) => {
    const sides = [...positions.subarray(i - (i % 3), i - (i % 3) + 3)].map((x, k) => x / ([0.9, 0.6, 0.35][k] ?? 1));
    return Math.abs(sides[i % 3] ?? 0) > 0.999 ? Math.sign(sides[i % 3] ?? 0) : 0;
  });
  const wrong = Uint8Array.from(right).reverse();
  const of = (colors: Uint8Array, flippedColors: Uint8Array) => {
    const samples = { positions, normals, colors, flippedColors };
    return codes({ ...frame, image, mesh: { positions, indices, samples } });
  };
  const found = [await of(right, wrong), await of(wrong, right), await of(wrong, wrong)];
  assert.deepEqual(
    found.map((each) => each.includes("TEXTURE_LOOKS_FLIPPED")),
    [false, true, false],
  );
});

test("a file that places copies of its only mesh is named", async () => {
  const json = (count: number) => {
    const nodes = Array.from({ length: count }, (_, k) => ({ mesh: 0, translation: [3 * k, 0, 0] }));
    return { ...gltfJson(mesh), nodes, scenes: [{ nodes: nodes.map((_, k) => k) }] };
  };
  const of = (count: number) => codes({ ...input, mesh: glbOf(json(count), gltfBuffer(mesh)) });
  assert.deepEqual(
    [await of(1), await of(2)].map((each) => each.includes("MESH_HOLDS_COPIES")),
    [false, true],
  );
});
