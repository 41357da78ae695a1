/** Small NPY files of numbers, such as `K.npy`. Depth maps and masks are read by the module of formats. */

/** The numbers of each type of NumPy, by their place in the data. */
const readers: Record<string, [bytes: number, read: (view: DataView, at: number, little: boolean) => number]> = {
  f4: [4, (view, at, little) => view.getFloat32(at, little)],
  f8: [8, (view, at, little) => view.getFloat64(at, little)],
  i2: [2, (view, at, little) => view.getInt16(at, little)],
  i4: [4, (view, at, little) => view.getInt32(at, little)],
  i8: [8, (view, at, little) => Number(view.getBigInt64(at, little))],
  u2: [2, (view, at, little) => view.getUint16(at, little)],
  u4: [4, (view, at, little) => view.getUint32(at, little)],
};

/** Most numbers of a small array: two thousand matrices. */
const MAX_NUMBERS = 1 << 15;

/**
 * The numbers in an NPY file, as rows of its last axis, and these in a list for each matrix of a batch. `undefined` for another
 * type or more numbers.
 */
export function npyNumbers(bytes: Uint8Array): number[][][] | undefined {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 12) return undefined;
  const isFirst = bytes[6] === 1;
  const begin = isFirst ? 10 : 12;
  const end = begin + (isFirst ? view.getUint16(8, true) : view.getUint32(8, true));
  if (end > bytes.length) return undefined;
  const header = String.fromCharCode(...bytes.subarray(begin, Math.min(end, begin + 1024)));
  const [, order, type = ""] = /'descr':\s*'([<>|=])(\w\d)'/.exec(header) ?? [];
  const shape = (/'shape':\s*\(([\d,\s]*)\)/.exec(header)?.[1] ?? "")
    .split(",")
    .filter((text) => text.trim() !== "")
    .map(Number);
  const [size, read] = readers[type] ?? [];
  const count = shape.reduce((product, side) => product * side, 1);
  if (size === undefined || read === undefined || !(count > 0 && count <= MAX_NUMBERS)) return undefined;
  if (end + count * size > bytes.length) return undefined;
  const columns = shape.at(-1) ?? 1;
  const rows = shape.at(-2) ?? 1;
  const isByColumns = /'fortran_order':\s*True/.test(header);
  // A batch by columns is rare enough.
  if (isByColumns && count !== rows * columns) return undefined;
  const at = (i: number) => read(view, end + i * size, order !== ">");
  return Array.from({ length: count / (rows * columns) }, (_, k) =>
    Array.from({ length: rows }, (_, row) =>
      Array.from({ length: columns }, (_, column) =>
        at(isByColumns ? column * rows + row : (k * rows + row) * columns + column),
      ),
    ),
  );
}
