/** Videos of measurements: folders with frames, and a generated one. */
import { join } from "node:path";
import { bumpyRing, compiledModule, pictureOf } from "./inputs.mjs";
import { fixed, markdownTable, mean, quantile } from "./table.mjs";

/**
 * @typedef {object} Video
 * @property {string} name
 * @property {any} mesh
 * @property {any[]} frames inputs of `Tracker.next`, as typed arrays
 */

/** Noise of the generated depth, relative. */
const noise = 0.002;

/**
 * A folder with `frame_*`, decoded.
 * @param {string} folder
 * @returns {Promise<Video>}
 */
export async function readVideo(folder) {
  const [{ frameNames, meshIn, readFrame, readMeshFile }, { resolveFrame }, { fileReaders }] = await Promise.all(
    ["case-folder.js", "input/frames.js", "file-readers.js"].map(compiledModule),
  );
  const frames = [];
  for (const name of await frameNames(folder)) {
    const { cameraToWorld: _, ...input } = (await readFrame(join(folder, name), {})).input;
    const { maskWidth: __, maskHeight: ___, ...frame } = (await resolveFrame(input, fileReaders)).core;
    frames.push(frame);
  }
  return { name: folder, mesh: await readMeshFile(meshIn(folder)), frames };
}

/**
 * A bumpy ring that turns before a wall.
 * @param {number} count
 * @returns {Video}
 */
export function turningRing(count) {
  const mesh = bumpyRing(20_000);
  const [width, height] = [640, 480];
  const frames = Array.from({ length: count }, (_, k) => {
    const [turn, tilt] = [(1.5 * k * Math.PI) / 180, 0.6 + 0.2 * Math.sin(k / 9)];
    const positions = mesh.positions.slice();
    for (let i = 0; i < positions.length; i += 3) {
      const [x = 0, y = 0, z = 0] = positions.subarray(i, i + 3);
      const [across, along] = [x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn)];
      const [up, out] = [along * Math.cos(tilt) - z * Math.sin(tilt), along * Math.sin(tilt) + z * Math.cos(tilt)];
      positions.set([across + 0.05 * Math.sin(k / 7), up, out], i);
    }
    const { depth, mask, camera } = pictureOf({ ...mesh, positions }, width, height);
    return {
      depth: depth.map((z, i) => z * (1 + noise * (((48_271 * i + 7919 * k) % 1009) / 1009 - 0.5))),
      width,
      height,
      mask,
      camera,
    };
  });
  return { name: "turning ring", mesh, frames };
}

/**
 * Prints the CPU time of a tracked frame in WebAssembly on this thread, with and without masks and photos. The first frame,
 * which is searched, does not count.
 * @param {Video} video
 * @param {number} runs
 */
export async function profileVideo({ name, mesh, frames }, runs) {
  const { createAligner } = await compiledModule("index.js");
  const aligner = await createAligner();
  const prepared = await aligner.prepareMesh(mesh);
  const rows = [];
  for (const hasPhotos of frames.some(({ image }) => image) ? [false, true] : [false]) {
    for (const masks of ["all", "first"]) {
      /** @type {number[]} */
      const times = [];
      const states = new Map();
      // In the first run, caches and compilers warm up.
      for (let run = 0; run <= runs; run++) {
        const tracker = await aligner.track(prepared);
        for (const [k, { mask, image, ...frame }] of frames.entries()) {
          const hasMask = mask !== undefined && (masks === "all" || k === 0);
          const input = { ...frame, ...(hasMask ? { mask } : {}), ...(hasPhotos && image ? { image } : {}) };
          const begun = process.cpuUsage();
          const { state } = await tracker.next(input);
          const { user, system } = process.cpuUsage(begun);
          if (run === 0 || k === 0) continue;
          times.push((user + system) / 1000);
          states.set(state, (states.get(state) ?? 0) + 1);
        }
        tracker.close();
      }
      const [middle, late] = [0.5, 0.95].map((share) => quantile(times, share));
      const tracked = [...states].map(([state, count]) => `${count / runs} ${state}`).join(", ");
      rows.push([masks, hasPhotos ? "yes" : "no", fixed(middle, 1), fixed(late, 1), fixed(mean(times), 1), tracked]);
    }
  }
  prepared.dispose();
  const head = ["masks", "photos", "median, ms", "p95, ms", "mean, ms", "frames"];
  console.log(`\n${name}, CPU time of a tracked frame in WebAssembly, ${runs} runs\n\n${markdownTable(head, rows)}`);
}
