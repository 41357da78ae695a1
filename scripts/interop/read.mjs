/** Our readers on a file: what they return, as plain numbers, or the error. */
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { NodeIO } from "@gltf-transform/core";
import { packageDir } from "../lib/paths.mjs";
import { root } from "./cells.mjs";

/** @typedef {import("./cells.mjs").Written} Written */
/** @type {typeof import("../../pkg/formats.js")} */
const formats = await import(join(packageDir, "formats.js"));
/** @type {typeof import("../../pkg/conventions.js")} */
const { applyToPoints, fromRle } = await import(join(packageDir, "conventions.js"));

/** Points of the surface whose colours are compared. */
const EVERY = 16;
const SIZE = { width: 160, height: 120 };

/** @type {Record<string, (bytes: Uint8Array, written: Written) => Promise<object | number>>} */
const readers = {
  async mesh(bytes, { file, expect }) {
    const names = readdirSync(dirname(file)).flatMap((name) => [name, `./${name}`]);
    const resources = Object.fromEntries(names.map((name) => [name, readFileSync(join(dirname(file), name))]));
    const mesh = await formats.readMesh(bytes, { resources, ...expect.options });
    const { positions, indices, origin = [0, 0, 0], samples, warnings, unread = [] } = mesh;
    const some = (/** @type {ArrayLike<number>} */ all) =>
      Array.from(all).filter((_, i) => Math.floor(i / 3) % EVERY === 0);
    const places = Array.from(positions, (each, i) => each + (origin[i % 3] ?? 0));
    const print = samples && { places: some(samples.positions), colors: some(samples.colors) };
    return { positions: places, indices: Array.from(indices), ...print, said: [...warnings, ...unread] };
  },
  async depth(bytes, { expect }) {
    const { data } = await formats.readDepth(bytes, expect.options);
    return { data: Array.from(data), said: [] };
  },
  async mask(bytes, { expect: { rle } }) {
    const text = () => JSON.parse(new TextDecoder().decode(bytes));
    const { data } = rle === undefined ? await formats.readMask(bytes) : fromRle(text(), rle, SIZE);
    return { data: Array.from(data, (each) => (each === 0 ? 0 : 1)), said: [] };
  },
  async camera(bytes) {
    const { fx, fy, cx, cy, warnings, doubts = [], unread = [] } = await formats.readCamera(bytes, SIZE);
    return { data: [fx, fy, cx, cy], said: [...warnings, ...doubts, ...unread] };
  },
  async pose(bytes) {
    const { points } = JSON.parse(readFileSync(join(root, "truth", "truth.json"), "utf8"));
    const read = await formats.readPose(bytes);
    return { data: Array.from(read ? applyToPoints(read.transform, Float64Array.from(points.flat())) : []), said: [] };
  },
  /** The first number of the colours in a GLB, without our reader. */
  async grey(_, { file }) {
    const [mesh] = (await new NodeIO().read(file)).getRoot().listMeshes();
    const colors = mesh?.listPrimitives()[0]?.getAttribute("COLOR_0")?.getArray() ?? [];
    return (colors[0] ?? 0) * (colors instanceof Float32Array ? 255 : 1);
  },
};

/** The result of our reader for a file that a program wrote, for `checks.py`. @param {Written} written */
export async function readBack(written) {
  const bytes = readFileSync(written.file);
  return readers[written.kind]?.(bytes, written).catch(({ code = "none", message }) => ({ code, message }));
}
