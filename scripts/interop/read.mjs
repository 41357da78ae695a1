/** Our readers on a file: what they return, as plain numbers, or the error. */
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { packageDir } from "../lib/paths.mjs";

/** @type {typeof import("../../pkg/formats.js")} */
const formats = await import(join(packageDir, "formats.js"));
/** @type {typeof import("../../pkg/conventions.js")} */
const { fromRle } = await import(join(packageDir, "conventions.js"));

/** A file that a program wrote; `expect` has what `checks.py` says, and options of our reader. */
/** @typedef {{ program: string, version: string, kind: string, variant: string, file: string, expect: any }} Written */

/** Points of the surface whose colours are compared. */
const EVERY = 16;
const SIZE = { width: 160, height: 120 };

/** @type {Record<string, (bytes: Uint8Array, written: Written) => Promise<object>>} */
const readers = {
  async mesh(bytes, { file, expect }) {
    const beside = readdirSync(dirname(file)).filter((name) => name !== basename(file));
    const names = beside.flatMap((name) => [name, `./${name}`]);
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
    const { data, width, height } = await formats.readDepth(bytes, expect.options);
    return { data: Array.from(data), width, height };
  },
  async mask(bytes, { expect: { rle } }) {
    const text = () => JSON.parse(new TextDecoder().decode(bytes));
    const read = rle === undefined ? await formats.readMask(bytes) : fromRle(text(), rle, SIZE);
    return { ...read, data: Array.from(read.data, (each) => (each === 0 ? 0 : 1)) };
  },
  async camera(bytes) {
    const read = await formats.readCamera(bytes, SIZE);
    return { ...read, said: [...read.warnings, ...(read.doubts ?? []), ...(read.unread ?? [])] };
  },
  async pose(bytes) {
    return { matrix: Array.from((await formats.readPose(bytes))?.transform.matrix ?? []) };
  },
};

/** Reads what a program wrote, for `checks.py`: the row with the path of what was read. @param {Written} written */
export async function readBack(written) {
  const bytes = readFileSync(written.file);
  const read = await readers[written.kind]?.(bytes, written).catch(({ code = "none", message }) => ({ code, message }));
  const path = `${written.file}.${written.kind}.read`;
  writeFileSync(path, JSON.stringify(read));
  return { ...written, read: path };
}
