/**
 * `npm run bench:masks -- FOLDER…`: how well the mask tool of the page finds objects in real photos. Intersection over union with
 * the given masks after one click in the middle of each, and after each of two strokes where most was wrong.
 */
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import { at } from "../lib/paths.mjs";
import { command } from "./command.mjs";
import { foldersWith, packageModule, within } from "./inputs.mjs";
import { fixed, markdownTable, median } from "./table.mjs";

/** Strokes after the click. */
const CORRECTIONS = 2;

/** The tool as plain JavaScript. */
async function tool() {
  const folder = at("target", "bench-masks");
  mkdirSync(folder, { recursive: true });
  const outfile = join(folder, "region.mjs");
  await build({ entryPoints: [at("www", "src", "masking", "region.ts")], bundle: true, format: "esm", outfile });
  return import(pathToFileURL(outfile).href);
}

/** The largest part of what a mask lacks or has too much, and its deepest pixel. */
function largestError(mask, truth, width) {
  const height = mask.length / width;
  let worst = null;
  const done = new Uint8Array(mask.length);
  for (let start = 0; start < mask.length; start++) {
    if (done[start] === 1 || mask[start] === truth[start]) continue;
    const kind = truth[start];
    const part = [start];
    done[start] = 1;
    for (let k = 0; k < part.length; k++) {
      const [x, y] = [part[k] % width, Math.floor(part[k] / width)];
      for (const [u, v] of [
        [x - 1, y],
        [x + 1, y],
        [x, y - 1],
        [x, y + 1],
      ]) {
        if (u < 0 || v < 0 || u >= width || v >= height) continue;
        const next = v * width + u;
        if (done[next] === 1 || mask[next] === truth[next] || truth[next] !== kind) continue;
        done[next] = 1;
        part.push(next);
      }
    }
    if (worst === null || part.length > worst.part.length) worst = { part, adds: kind === 1 };
  }
  return worst;
}

/** For each pixel of a part the distance to its boundary, in steps. */
function depths(part, width) {
  const inside = new Set(part);
  let layer = part.filter((p) => [-1, 1, -width, width].some((step) => !inside.has(p + step)));
  const depth = new Map(layer.map((p) => [p, 1]));
  for (let d = 2; layer.length > 0; d++) {
    const next = [];
    for (const p of layer) {
      for (const step of [-1, 1, -width, width]) {
        if (!inside.has(p + step) || depth.has(p + step)) continue;
        depth.set(p + step, d);
        next.push(p + step);
      }
    }
    layer = next;
  }
  return depth;
}

const pointOf = (pixel, width) => [pixel % width, Math.floor(pixel / width)];

/** The pixel of a part that is farthest from its boundary. */
function deepest(part, width) {
  let best = [part[0], 0];
  for (const [pixel, depth] of depths(part, width)) if (depth > best[1]) best = [pixel, depth];
  return best;
}

/** A stroke as a person draws it: along the largest error, well inside of it. */
function correction(mask, truth, width) {
  const error = largestError(mask, truth, width);
  if (error === null) return null;
  const depth = depths(error.part, width);
  const [middle, most] = deepest(error.part, width);
  const radius = Math.max(1, Math.min(6, most / 2));
  const [x, y] = pointOf(middle, width);
  // As far as the brush fits, in the direction in which it gets farthest.
  let best = [[x, y]];
  for (let turn = 0; turn < 16; turn++) {
    const [dx, dy] = [Math.cos((Math.PI * turn) / 16), Math.sin((Math.PI * turn) / 16)];
    const reach = (sign) => {
      let k = 0;
      while (
        (depth.get(Math.round(y + sign * (k + 1) * dy) * width + Math.round(x + sign * (k + 1) * dx)) ?? 0) > radius
      )
        k++;
      return [x + sign * k * dx, y + sign * k * dy];
    };
    const ends = [reach(-1), reach(1)];
    const length = ([a, b]) => (b === undefined ? 0 : Math.hypot(a[0] - b[0], a[1] - b[1]));
    if (length(ends) > length(best)) best = ends;
  }
  return { points: best, radius, adds: error.adds };
}

function iou(mask, truth) {
  let [both, either] = [0, 0];
  for (let i = 0; i < mask.length; i++) {
    both += mask[i] & truth[i];
    either += mask[i] | truth[i];
  }
  return either === 0 ? 1 : both / either;
}

/** The middle of a mask: its centroid or, where that is outside, its deepest pixel. */
function middleOf(mask, width) {
  const part = [];
  for (let i = 0; i < mask.length; i++) if (mask[i]) part.push(i);
  const mean = (of) => part.reduce((sum, p) => sum + of(p), 0) / part.length;
  const [x, y] = [mean((p) => p % width), mean((p) => Math.floor(p / width))].map(Math.round);
  return mask[y * width + x] ? [x, y] : pointOf(deepest(part, width)[0], width);
}

/**
 * The photos of folders, with their depth and the masks of their objects.
 * @param {readonly string[]} folders
 */
async function* photos(folders) {
  const { readDepth, readMask, loadFormats } = await packageModule("formats.js");
  await loadFormats();
  const { readImage } = await packageModule("wasm/formats.js");
  for (const folder of foldersWith("rgb.png", folders)) {
    const { data, width, height } = readImage(readFileSync(join(folder, "rgb.png")));
    const channels = data.length / (width * height);
    const rgba = Uint8ClampedArray.from({ length: 4 * width * height }, (_, i) =>
      i % 4 === 3 ? 255 : data[channels * Math.floor(i / 4) + (i % 4)],
    );
    const depth = (await readDepth(readFileSync(join(folder, "depth.npy")))).data;
    const objects = existsSync(join(folder, "objects")) ? within(join(folder, "objects")) : [];
    const masks = [];
    for (const path of foldersWith(
      "mask.png",
      [folder, ...objects].filter((one) => existsSync(join(one, "mask.png"))),
    )) {
      const { data: truth } = await readMask(readFileSync(join(path, "mask.png")));
      if (truth.length === width * height && truth.includes(1)) masks.push({ path, truth });
    }
    yield { view: { rgba, width, height }, depth, masks };
  }
}

await command("bench:masks", (parsed) =>
  parsed
    .description("measures the mask tool of the page on case and scene folders with rgb.png")
    .argument("<folders...>", "folders, or folders of them")
    .option("--each", "a line for each mask")
    .action(async (/** @type {string[]} */ folders, /** @type {{ each?: boolean }} */ { each }) => {
      const { regionOf } = await tool();
      const kinds = ["photo and depth", "photo alone"];
      const rows = kinds.map((kind) => ({ kind, found: /** @type {number[][]} */ ([]) }));
      for await (const { view, depth, masks } of photos(folders)) {
        for (const { path, truth } of masks) {
          for (const row of rows) {
            const seen = { ...view, depth: row.kind === kinds[0] ? depth : null };
            const strokes = [{ points: [middleOf(truth, view.width)], radius: 2, adds: true }];
            const ious = [];
            for (let step = 0; step <= CORRECTIONS; step++) {
              const mask = regionOf(seen, strokes);
              ious.push(iou(mask, truth));
              const next = correction(mask, truth, view.width);
              if (next !== null) strokes.push(next);
            }
            row.found.push(ious);
            if (each) console.log(row.kind, ious.map((value) => fixed(value, 3)).join(" "), path);
          }
        }
      }
      const header = ["", "masks", "one click", "one correction", "two corrections"];
      const table = rows.map(({ kind, found }) => [
        ...[kind, `${found.length}`],
        ...Array.from({ length: CORRECTIONS + 1 }, (_, step) => fixed(median(found.map((ious) => ious[step])), 3)),
      ]);
      console.log(markdownTable(header, table));
    }),
);
