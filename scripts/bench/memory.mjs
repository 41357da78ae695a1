/**
 * `npm run bench:memory [-- --meshes DIR]`: the WebAssembly memory that one alignment of a large input takes, which has
 * a limit, and whether many alignments take more than few.
 */
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { buildPackage } from "../lib/package.mjs";
import { step } from "../lib/step.mjs";
import { command, count } from "./command.mjs";
import { bumpyRing, freshCore, freshMemory, compiledModule, pictureOf, qualities } from "./inputs.mjs";
import { markdownTable, megabytes, printWithin } from "./table.mjs";
import { blocksPng, texturedGlb } from "./textured.mjs";

/** @typedef {import("./inputs.mjs").TypedCase} TypedCase */

/** The peaks that `--json` writes. @type {{ name: string, bytes: number, limit: number }[]} */
const measured = [];

/** Limit of the core's memory, in bytes: 128 MB. */
const limit = 128_000_000;
/** The input that the limit holds for. */
const large = { triangles: 227_000, width: 1920, height: 1080 };
/** Limit of both modules together with a photo and a texture, in bytes: 160 MB. */
const colorLimit = 160_000_000;
/** Photos and textures: the limit holds for the first; the others are reduced while they are read. */
const pictures = [
  { photo: [1920, 1080], texture: [2048, 2048] },
  { photo: [3840, 2160], texture: [2048, 2048] },
  { photo: [1920, 1080], texture: [8192, 8192] },
];
/** The mixed sizes: triangles, width, height. All have come up within the first alignments that the last are held against. */
const mixed = [
  ...[
    [500, 160, 120],
    [60_000, 640, 480],
    [4000, 320, 240],
    [20_000, 848, 480],
    [1000, 640, 480],
    [120_000, 320, 240],
  ],
  ...[
    [8000, 1280, 720],
    [2000, 160, 120],
    [30_000, 512, 512],
    [300, 1024, 768],
  ],
];
const early = 50;

/**
 * The mesh of the folder's GLB files that is nearest in size to what is asked for, and its name.
 * @param {string} folder
 * @returns {Promise<{ name: string, mesh: TypedCase["mesh"], off?: number }>}
 */
async function meshFrom(folder) {
  const [{ readMesh }, { formatsModule }] = await Promise.all(
    ["input/mesh.js", "formats-module.js"].map(compiledModule),
  );
  let best = null;
  for (const name of readdirSync(folder).filter((file) => file.endsWith(".glb"))) {
    const bytes = new Uint8Array(readFileSync(join(folder, name)));
    const { mesh } = await readMesh(bytes, () => formatsModule.load(), false);
    const off = Math.abs(Math.log(mesh.indices.length / 3 / large.triangles));
    if (best === null || off < best.off) best = { name, mesh, off };
  }
  if (best === null) throw new Error(`${folder} holds no GLB file. Remedy: name another, or leave --meshes out.`);
  return best;
}

/**
 * One line a call: what the memory has grown to after one alignment in a new instance.
 * @param {string | undefined} meshes
 */
async function measurePeaks(meshes) {
  const { name, mesh } = meshes
    ? await meshFrom(meshes)
    : { name: "a generated mesh", mesh: bumpyRing(large.triangles) };
  const input = pictureOf(mesh, large.width, large.height, 2);
  const pixels = input.mask.filter(Boolean).length;
  console.log(
    `\n${name}: ${mesh.indices.length / 3} triangles, ${mesh.positions.length / 3} vertices; depth ${large.width}×${large.height}, ${pixels} pixels in the mask. MB = 10⁶ bytes.\n`,
  );
  const given = [input.depth, input.mask, mesh.positions, mesh.indices].reduce(
    (sum, array) => sum + array.byteLength,
    0,
  );
  const peaks = [];
  for (const options of [...(await qualities()).map((quality) => ({ quality })), { preset: "paper" }]) {
    const { aligner, memory: core } = await freshCore();
    const memory = "preset" in options ? await freshMemory("registration") : core;
    const before = memory.buffer.byteLength;
    await aligner.align(input, options);
    peaks.push(/** @type {const} */ ([Object.values(options).join(), before, given, memory.buffer.byteLength]));
  }
  keep(peaks, limit);
  return printWithin("one alignment", ["empty", "input", "peak"], peaks, limit);
}

/** @param {readonly (readonly [name: string, ...bytes: number[]])[]} rows @param {number} most */
function keep(rows, most) {
  measured.push(...rows.map(([name, ...bytes]) => ({ name, bytes: bytes.at(-1) ?? 0, limit: most })));
}

/** One line a pair of photo and texture: the memory of both modules after one alignment in new instances. */
async function measureColor() {
  const mesh = bumpyRing(large.triangles);
  const input = pictureOf(mesh, large.width, large.height, 2);
  console.log(
    `\nThe same mesh as a GLB with a PNG texture, and a photo as PNG, read by the module of the file readers.\n`,
  );
  const peaks = [];
  for (const { photo, texture } of pictures) {
    const { aligner, memory } = await freshCore();
    const readers = await freshMemory("formats");
    const colored = { ...input, mesh: await texturedGlb(mesh, blocksPng(texture)), image: blocksPng(photo) };
    const { diagnostics } = await aligner.align(colored);
    if (diagnostics.color === undefined) throw new Error("The colours were not used.");
    const [core, read] = [memory.buffer.byteLength, readers.buffer.byteLength];
    const name = `photo ${photo.join("×")}, texture ${texture.join("×")}`;
    peaks.push(/** @type {const} */ ([name, core, read, core + read]));
  }
  keep(peaks, colorLimit);
  return printWithin("with colour", ["core", "readers", "both"], peaks, colorLimit);
}

/**
 * Measures the memory after a few alignments of mixed sizes, and after many.
 * @param {number} alignments
 */
async function measureGrowth(alignments) {
  const inputs = mixed.map(([triangles = 0, width = 0, height = 0]) => pictureOf(bumpyRing(triangles), width, height));
  const { aligner, memory } = await freshCore();
  const after = new Map();
  await step(`${alignments} alignments on one instance`, async () => {
    for (let i = 1; i <= alignments; i++) {
      const input = inputs[(i * 7) % inputs.length];
      await aligner.align(input, { quality: "fast", seed: i });
      if (i === Math.min(early, alignments) || i === alignments) after.set(i, memory.buffer.byteLength);
    }
  });
  const rows = [...after].map(([i, bytes]) => [`after ${i}`, megabytes(bytes)]);
  console.log(`\n${markdownTable([`${mixed.length} sizes, fast`, "memory, MB"], rows)}`);
  const [few = 0, many = few] = after.values();
  console.log(many === few ? "\nFlat." : `\nIt grew by ${megabytes(many - few)} MB.`);
  return many === few;
}

await command("bench:memory", (program) =>
  program
    .description("Measures the WebAssembly memory of a large alignment, and of many. Fails where either is too much.")
    .option(
      "--meshes <dir>",
      "take the GLB file of a folder that has nearest to 227 000 triangles, not a generated mesh",
    )
    .option("--alignments <n>", "how many on one instance", count, 500)
    .option("--json <file>", "keeps the peaks")
    .action(async ({ meshes, alignments, json }) => {
      await buildPackage();
      const isShapeWithin = await measurePeaks(meshes);
      const isWithin = (await measureColor()) && isShapeWithin;
      console.log();
      const isFlat = await measureGrowth(alignments);
      if (json !== undefined) writeFileSync(json, `${JSON.stringify(measured)}\n`);
      if (!isWithin || !isFlat) process.exitCode = 1;
    }),
);
