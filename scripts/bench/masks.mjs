/**
 * `npm run bench:masks -- FOLDER…`: how well the mask tool of the page finds objects in real photos. Intersection over union with
 * the given masks after one click in the middle of each, and after each of two strokes where most was wrong.
 */
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { at } from "../lib/paths.mjs";
import { command } from "./command.mjs";
import { foldersWith, packageModule, within } from "./inputs.mjs";
import { fixed, markdownTable, median } from "./table.mjs";

/** Strokes after the click. */
const CORRECTIONS = 2;

/** The tool as plain JavaScript. */
async function tool() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const folder = at("target", "bench-masks");
  mkdirSync(folder, { recursive: true });
  const outfile = join(folder, "region.mjs");
  await build({ entryPoints: [at("www", "src", "masking", "region.ts")], bundle: true, format: "esm", outfile });
  return import(pathToFileURL(outfile).href);
}

/** @typedef {[x: number, y: number]} Point */

/** @type {readonly Point[]} */
const sides = [
  [-1, 0],
  [1, 0],
  [0, -1],
  [0, 1],
];

/** @param {number} pixel @param {number} width @returns {Point} */
const pointOf = (pixel, width) => [pixel % width, Math.floor(pixel / width)];

/**
 * The largest connected part of what a mask lacks or has too much.
 * @param {Uint8Array} mask
 * @param {Uint8Array} truth
 * @param {number} width
 */
function largestError(mask, truth, width) {
  const height = mask.length / width;
  /** @type {number[]} */
  let worst = [];
  const isDone = mask.map((value, i) => Number(value === truth[i]));
  for (let start = 0; start < mask.length; start++) {
    if (isDone[start] === 1) continue;
    const part = [start];
    isDone[start] = 1;
    for (const pixel of part) {
      const [x, y] = pointOf(pixel, width);
      for (const [dx, dy] of sides) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
        const next = pixel + dy * width + dx;
        if (isDone[next] === 1 || truth[next] !== truth[start]) continue;
        isDone[next] = 1;
        part.push(next);
      }
    }
    if (part.length > worst.length) worst = part;
  }
  return worst;
}

/**
 * For each pixel of a part the distance to its boundary, in steps.
 * @param {readonly number[]} part
 * @param {number} width
 */
function depthsOf(part, width) {
  const inside = new Set(part);
  const steps = sides.map(([dx, dy]) => dy * width + dx);
  let layer = part.filter((pixel) => steps.some((step) => !inside.has(pixel + step)));
  const depths = new Map(layer.map((pixel) => [pixel, 1]));
  for (let depth = 2; layer.length > 0; depth++) {
    const next = [];
    for (const pixel of layer) {
      for (const other of steps.map((step) => pixel + step)) {
        if (!inside.has(other) || depths.has(other)) continue;
        depths.set(other, depth);
        next.push(other);
      }
    }
    layer = next;
  }
  return depths;
}

/**
 * The pixel that is farthest from the boundary, and how far.
 * @param {ReadonlyMap<number, number>} depths
 */
function deepest(depths) {
  let [best, most] = [0, 0];
  for (const [pixel, depth] of depths) if (depth > most) [best, most] = [pixel, depth];
  return { best, most };
}

/** The widest brush that is used, pixels. */
const WIDEST = 6;

/**
 * A stroke as a person draws it: along the largest error, well inside of it; null if nothing is wrong.
 * @param {Uint8Array} mask
 * @param {Uint8Array} truth
 * @param {number} width
 */
function correction(mask, truth, width) {
  const part = largestError(mask, truth, width);
  const [first] = part;
  if (first === undefined) return null;
  const depths = depthsOf(part, width);
  const { best, most } = deepest(depths);
  const radius = Math.max(1, Math.min(WIDEST, most / 2));
  const [x, y] = pointOf(best, width);
  /** @type {Point[]} */
  let points = [[x, y]];
  let longest = 0;
  // As far as the brush fits, in the direction in which it gets farthest.
  for (let turn = 0; turn < 16; turn++) {
    const [dx, dy] = [Math.cos((Math.PI * turn) / 16), Math.sin((Math.PI * turn) / 16)];
    const [back = 0, forth = 0] = [-1, 1].map((sign) => {
      const fits = (/** @type {number} */ k) =>
        (depths.get(Math.round(y + sign * k * dy) * width + Math.round(x + sign * k * dx)) ?? 0) > radius;
      let reach = 0;
      while (fits(reach + 1)) reach++;
      return reach;
    });
    if (back + forth <= longest) continue;
    longest = back + forth;
    points = [
      [x - back * dx, y - back * dy],
      [x + forth * dx, y + forth * dy],
    ];
  }
  return { points, radius, adds: truth[first] === 1 };
}

/** @param {Uint8Array} mask @param {Uint8Array} truth */
function iou(mask, truth) {
  let [both, either] = [0, 0];
  mask.forEach((value, i) => {
    both += value & (truth[i] ?? 0);
    either += value | (truth[i] ?? 0);
  });
  return either === 0 ? 1 : both / either;
}

/**
 * The middle of a mask: its centroid or, where that is outside, its deepest pixel.
 * @param {Uint8Array} mask
 * @param {number} width
 */
function middleOf(mask, width) {
  /** @type {number[]} */
  const part = [];
  for (let i = 0; i < mask.length; i++) if (mask[i]) part.push(i);
  const mean = (/** @type {0 | 1} */ axis) =>
    Math.round(part.reduce((sum, pixel) => sum + pointOf(pixel, width)[axis], 0) / part.length);
  const [x, y] = [mean(0), mean(1)];
  return mask[y * width + x] ? /** @type {Point} */ ([x, y]) : pointOf(deepest(depthsOf(part, width)).best, width);
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
        ...Array.from({ length: CORRECTIONS + 1 }, (_, step) => fixed(median(found.map((ious) => ious[step] ?? 0)), 3)),
      ]);
      console.log(markdownTable(header, table));
    }),
);
