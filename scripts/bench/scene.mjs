/**
 * `npm run bench:scene`: the WebAssembly memory that a scene of twelve large meshes takes, which has a limit, and the time
 * of a scene of five objects next to that of its objects one by one.
 */
import { buildPackage } from "../lib/package.mjs";
import { command, count } from "./command.mjs";
import { bumpyRing, freshCore, freshMemory, pictureOf } from "./inputs.mjs";
import { fixed, markdownTable, printWithin } from "./table.mjs";

/** @typedef {import("./inputs.mjs").TypedCase} TypedCase */

/** Limit of the memory of the core and the joint module together, in bytes: 300 MB. */
const limit = 300_000_000;
/** Objects and triangles of each that the limit holds for, and the size of the image. */
const large = { objects: 12, triangles: 100_000, width: 1280, height: 960 };
/** The scene that is timed, and the most that it may take, relative to its objects one by one. */
const timed = { objects: 5, triangles: 20_000, width: 640, height: 480 };
const mostTime = 1.3;

/**
 * Bumpy rings side by side before a wall, each with a mesh of its own.
 * @param {{ objects: number, triangles: number, width: number, height: number }} size
 */
function sceneOf({ objects, triangles, width, height }) {
  const columns = Math.ceil(Math.sqrt(objects));
  const rows = Math.ceil(objects / columns);
  const [tileWidth, tileHeight] = [Math.floor(width / columns), Math.floor(height / rows)];
  const depth = new Float32Array(width * height).fill(2);
  const camera = { fx: tileHeight, fy: tileHeight, cx: (width - 1) / 2, cy: (height - 1) / 2 };
  const tiles = Array.from({ length: objects }, (_, k) => {
    const tile = pictureOf(bumpyRing(triangles), tileWidth, tileHeight);
    const mask = new Uint8Array(width * height);
    for (let v = 0; v < tileHeight; v++) {
      const at = (v + Math.floor(k / columns) * tileHeight) * width + (k % columns) * tileWidth;
      depth.set(tile.depth.subarray(v * tileWidth, (v + 1) * tileWidth), at);
      mask.set(tile.mask.subarray(v * tileWidth, (v + 1) * tileWidth), at);
    }
    return { mask, mesh: tile.mesh };
  });
  // The wall, as what they may touch: so that every step of a scene runs.
  return { depth, width, height, camera, objects: tiles, support: { normal: [0, 0, -1], d: 2 } };
}

/** Measures the memory of a large scene, with meshes as arrays and prepared. */
async function measureMemory() {
  const scene = sceneOf(large);
  const peaks = [];
  for (const isPrepared of [false, true]) {
    const { aligner, memory: core } = await freshCore();
    // Scenes are aligned in the joint module; the core prepares meshes.
    const joint = await freshMemory("joint");
    const used = () => core.buffer.byteLength + joint.buffer.byteLength;
    const before = used();
    const prepare = async (/** @type {TypedCase["mesh"]} */ mesh) => (isPrepared ? aligner.prepareMesh(mesh) : mesh);
    const meshes = await Promise.all(scene.objects.map(({ mesh }) => prepare(mesh)));
    const objects = scene.objects.map(({ mask }, i) => ({ mask, mesh: meshes[i] }));
    const result = await aligner.alignScene({ ...scene, objects });
    for (const { error } of result.objects) if (error !== undefined) throw error;
    peaks.push(/** @type {const} */ ([isPrepared ? "prepared" : "arrays", before, used()]));
  }
  const { objects, triangles, width, height } = large;
  console.log(
    `\n${objects} objects of ${triangles} triangles, depth ${width}×${height}, one thread. MB = 10⁶ bytes.\n`,
  );
  return printWithin("meshes", ["empty", "peak"], peaks, limit);
}

/**
 * Measures the time of a scene next to that of its objects one by one, alternating.
 * @param {number} rounds
 */
async function measureTime(rounds) {
  const { objects, support, ...view } = sceneOf(timed);
  const { aligner } = await freshCore();
  const alone = async () => {
    for (const object of objects) await aligner.align({ ...view, ...object });
  };
  const together = () => aligner.alignScene({ ...view, support, objects });
  const seconds = async (/** @type {() => Promise<unknown>} */ run) => {
    const begun = process.cpuUsage();
    await run();
    const { user, system } = process.cpuUsage(begun);
    return (user + system) / 1e6;
  };
  await alone();
  const times = { alone: Infinity, together: Infinity };
  for (let i = 0; i < rounds; i++) {
    times.alone = Math.min(times.alone, await seconds(alone));
    times.together = Math.min(times.together, await seconds(together));
  }
  const ratio = times.together / times.alone;
  const rows = [[fixed(times.alone, 2), fixed(times.together, 2), fixed(ratio, 2), fixed(mostTime, 2)]];
  console.log(`\n${objects.length} objects, one thread, CPU seconds, the least of ${rounds}\n`);
  console.log(markdownTable(["one by one", "scene", "ratio", "limit"], rows));
}

await command("bench:scene", (program) =>
  program
    .description("Measures memory and time of scenes. Fails where they take too much memory.")
    .option("--rounds <n>", "how often the times are measured", count, 3)
    .action(async ({ rounds }) => {
      await buildPackage();
      const isWithin = await measureMemory();
      await measureTime(rounds);
      if (!isWithin) process.exitCode = 1;
    }),
);
