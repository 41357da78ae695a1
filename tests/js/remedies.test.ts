/** The commands that errors and warnings of mesh files name, run as they are written; afterwards, the files can be read. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { chmodSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { delimiter, join } from "node:path";
import { after, test } from "node:test";
import { createDefaultContainer, write } from "ktx-parse";
import { readMesh } from "sim3align/formats";
import { createAligner } from "sim3align/inline";
import { dracoGltf, glbFrom, meshoptGltf } from "../support/compressed.js";
import { repository } from "../support/environment.js";
import { fixture, glbOf, gltfBuffer, gltfJson, png, texturedJson } from "../support/files.js";
import { blob } from "../support/scene.js";

const folder = mkdtempSync(join(tmpdir(), "sim3align-remedies-"));
after(() => rmSync(folder, { recursive: true, force: true }));

const isWindows = process.platform === "win32";
const mesh = blob(8, 10);

/** Runs a command line with the files `in` and `out` in a folder; npx finds the programs of the repository. */
function run(command: string, place: string): void {
  const line = command.replaceAll(/\b(in|out)\.(\w+)/g, (name) => JSON.stringify(join(place, name)));
  const { status, stdout, stderr } = spawnSync(line, {
    cwd: repository,
    shell: true,
    encoding: "utf8",
    env: { ...process.env, npm_config_offline: "true", PATH: `${folder}${delimiter}${process.env.PATH}` },
  });
  assert.equal(status, 0, `${line}\n${stdout}\n${stderr}`);
}

/** The error for a file, or what is said about its colours; that for compressed geometry comes where there are no decoders. */
async function complaint(file: Uint8Array, isCompressed = false): Promise<string> {
  try {
    using aligner = await createAligner();
    if (isCompressed) await aligner.prepareMesh(file);
    return (await readMesh(file)).warnings.join();
  } catch (error) {
    assert.ok(error instanceof Error && error.name === "Sim3AlignError");
    return error.message;
  }
}

/** A GLB with a texture. */
function textured(image: Uint8Array, mimeType: string, texture: object, extensionsUsed: string[] = []): Uint8Array {
  const place = gltfBuffer(mesh);
  const { bufferViews } = gltfJson(mesh);
  const json = texturedJson(mesh, texture, {
    ...(extensionsUsed.length > 0 ? { extensionsUsed } : {}),
    bufferViews: [...bufferViews, { buffer: 0, byteOffset: place.length, byteLength: image.length }],
    buffers: [{ byteLength: place.length + image.length }],
    images: [{ bufferView: 2, mimeType }],
  });
  return glbOf(json, Buffer.concat([place, image]));
}

/** Writes a program `ktx` that extracts one blue pixel: the real one comes from no package registry. */
function standInForKtx(): void {
  const blue = Buffer.from(png(Uint8Array.of(10, 20, 200), 1, 1, 3)).toString("base64");
  const lines = [
    "#!/usr/bin/env node",
    "const [command, from, to] = process.argv.slice(2);",
    'if (command === "--version") console.log("ktx version: v4.3.2");',
    'else if (command !== "extract" || !from.endsWith(".ktx2")) process.exit(1);',
    `else require("node:fs").writeFileSync(to, Buffer.from("${blue}", "base64"));`,
  ];
  writeFileSync(join(folder, "ktx"), lines.join("\n"));
  chmodSync(join(folder, "ktx"), 0o755);
}

function ktx2(): Uint8Array {
  const container = createDefaultContainer();
  Object.assign(container, { pixelWidth: 1, pixelHeight: 1, vkFormat: 43, typeSize: 1 });
  container.levels = [{ levelData: Uint8Array.of(10, 20, 200, 255), uncompressedByteLength: 4 }];
  return write(container);
}

/** A texture as AVIF, written by the program that converts it back. */
function avif(): Uint8Array {
  const place = mkdtempSync(join(folder, "avif-"));
  writeFileSync(join(place, "in.glb"), textured(png(Uint8Array.of(10, 20, 200), 1, 1, 3), "image/png", { source: 0 }));
  run("npx @gltf-transform/cli avif in.glb out.glb", place);
  return readFileSync(join(place, "out.glb"));
}

const color = [10, 20, 200] as const;
const basis = { extensions: { KHR_texture_basisu: { source: 0 } } };
const files: readonly (readonly [what: string, make: () => Uint8Array, command: RegExp, isColored: boolean])[] = [
  ["Draco", () => glbFrom(dracoGltf(mesh, color)), /npx \S*cli copy in\.glb out\.glb/, true],
  [
    "EXT_meshopt_compression",
    () => glbFrom(meshoptGltf(mesh, "EXT_meshopt_compression", true)),
    /npx \S*cli copy in\.glb out\.glb/,
    false,
  ],
  [
    "KHR_meshopt_compression",
    () => glbFrom(meshoptGltf(mesh, "KHR_meshopt_compression", true)),
    /npx gltfpack .*? -o out\.glb/,
    false,
  ],
  ["a texture as AVIF", avif, /npx \S*cli png .*? out\.glb/, true],
  [
    "a texture as KTX2",
    () => textured(ktx2(), "image/ktx2", basis, ["KHR_texture_basisu"]),
    /ktxdecompress in\.glb out\.glb/,
    true,
  ],
];

for (const [what, make, pattern, isColored] of files) {
  test(`the command that the message for ${what} names`, { skip: isWindows }, async () => {
    standInForKtx();
    const place = mkdtempSync(join(folder, "case-"));
    const file = make();
    writeFileSync(join(place, "in.glb"), file);
    const [command = ""] = pattern.exec(await complaint(file, /Draco|meshopt/.test(what))) ?? [];
    assert.notEqual(command, "");
    // The second command of a message shares the program of the first.
    run(command.startsWith("npx") ? command : `npx @gltf-transform/cli ${command}`, place);
    const { positions, indices, samples, warnings } = await readMesh(readFileSync(join(place, "out.glb")));
    assert.deepEqual(warnings, []);
    assert.equal(indices.length, mesh.indices.length);
    const extents = (all: Float32Array) => [Math.min(...all), Math.max(...all)];
    const [found, expected] = [extents(positions), extents(mesh.positions)];
    for (const [i, x] of expected.entries()) assert.ok(Math.abs((found[i] ?? Number.NaN) - x) < 1e-3, `${found}`);
    // AVIF has losses.
    for (const [i, value] of isColored ? color.entries() : []) {
      assert.ok(Math.abs((samples?.colors[i] ?? Number.NaN) - value) <= 2, `${samples?.colors.subarray(0, 3)}`);
    }
  });
}

test("the command that the message for a missing buffer names", { skip: isWindows }, async () => {
  const place = mkdtempSync(join(folder, "case-"));
  const buffers = ["gltf_buffer_0.bin", "gltf_buffer_1.bin"];
  const resources = Object.fromEntries(buffers.map((name) => [name, fixture(`mesh-external-${name}`)]));
  for (const [name, bytes] of Object.entries({ ...resources, "in.gltf": fixture("mesh-external.gltf") })) {
    writeFileSync(join(place, name), bytes);
  }
  const message = await complaint(fixture("mesh-external.gltf"));
  const [command = ""] = /npx \S*cli copy in\.gltf out\.glb/.exec(message) ?? [];
  run(command, place);
  const read = await readMesh(readFileSync(join(place, "out.glb")));
  assert.deepEqual(read.indices, (await readMesh(fixture("mesh-external.gltf"), { resources })).indices);
});
