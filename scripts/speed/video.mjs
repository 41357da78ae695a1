/** CPU time of a tracked frame as WebAssembly on this thread. */
import { basename } from "node:path";
import { fixed, markdownTable, quantile } from "../bench/table.mjs";
import { bumpyRing, compiledModule, createAligner, pictureOf } from "./inputs.mjs";

/** @typedef {{ name: string, mesh: any, frames: any[] }} Video frames are inputs of `Tracker.next`, as typed arrays */

/**
 * A folder with `frame_*`, decoded.
 * @param {string} folder
 * @returns {Promise<Video>}
 */
async function readVideo(folder) {
  const [{ openFrames }, { resolveFrame }, { fileReaders }] = await Promise.all(
    ["case-folder.js", "input/resolve.js", "modules/readers.js"].map(compiledModule),
  );
  const frames = [];
  const { mesh, names, read } = await openFrames(folder);
  for (const name of names) {
    const { cameraToWorld: _, ...input } = (await read(name)).input;
    const { maskWidth: __, maskHeight: ___, ...frame } = (await resolveFrame(input, fileReaders)).core;
    frames.push(frame);
  }
  return { name: basename(folder), mesh, frames };
}

/** A bumpy ring that turns before a wall. @param {number} count @returns {Video} */
function turningRing(count) {
  const mesh = bumpyRing(20_000);
  const frames = Array.from({ length: count }, (_, k) => {
    const [cosine, sine] = [Math.cos((1.5 * k * Math.PI) / 180), Math.sin((1.5 * k * Math.PI) / 180)];
    const positions = mesh.positions.slice();
    for (let i = 0; i < positions.length; i += 3) {
      const [x = 0, y = 0] = positions.subarray(i, i + 2);
      positions.set([x * cosine - y * sine, x * sine + y * cosine], i);
    }
    const { depth, mask, camera, width, height } = pictureOf({ ...mesh, positions }, 640, 480);
    // A thousandth of noise.
    const noisy = depth.map((z, i) => z * (1 + 1e-3 * (((48_271 * i + 7919 * k) % 1009) / 504 - 1)));
    return { depth: noisy, width, height, mask, camera };
  });
  return { name: "turning ring", mesh, frames };
}

/**
 * Prints the median and the 95th percentile with masks in all frames, and in the first only. The first frame, which is
 * searched, does not count.
 * @param {readonly string[]} folders with frames; a generated video without
 * @param {{ runs: number, quick: boolean }} options
 */
export async function measureVideo(folders, { runs, quick }) {
  const aligner = await createAligner();
  const videos = folders.length > 0 ? await Promise.all(folders.map(readVideo)) : [turningRing(quick ? 8 : 60)];
  const rows = [];
  for (const { name, mesh, frames } of videos) {
    for (const masks of ["all", "first"]) {
      /** @type {number[]} */
      const times = [];
      // The first run compiles.
      for (let run = 0; run <= runs; run++) {
        const tracker = await aligner.track(mesh);
        for (const [k, { mask, ...frame }] of frames.entries()) {
          const began = process.cpuUsage();
          await tracker.next(mask !== undefined && (masks === "all" || k === 0) ? { ...frame, mask } : frame);
          const { user, system } = process.cpuUsage(began);
          if (run > 0 && k > 0) times.push((user + system) / 1000);
        }
        tracker.dispose();
      }
      rows.push([
        `${name}, ${frames.length} frames`,
        masks,
        ...[0.5, 0.95].map((share) => fixed(quantile(times, share), 1)),
      ]);
    }
  }
  console.log(`\n${markdownTable(["tracked frame", "masks", "median, ms", "p95, ms"], rows)}`);
}
