/** Where the numbers of each Gaussian are in a PLY file of 3D Gaussian Splatting. */

import { plyHeader } from "../formats/splat-files.js";
import { failure } from "../values/error.js";
import { MAX_DEGREE } from "./harmonics.js";

/** Offsets, in bytes, from the beginning of a Gaussian. */
export interface GaussianLayout {
  /** The first byte of the first Gaussian. */
  start: number;
  /** Number of Gaussians. */
  count: number;
  /** Bytes per Gaussian. */
  stride: number;
  position: readonly number[];
  /** `null` if there is none. */
  normal: readonly number[] | null;
  /** Logarithms of the standard deviations. */
  scales: readonly number[];
  /** w, x, y, z. */
  rotation: readonly number[];
  /** Spherical harmonics from degree 1 on: those of red, of green, of blue. */
  harmonics: readonly number[];
}

/** Bytes of the types of properties. */
const sizes: Readonly<Record<string, number>> = {
  ...{ char: 1, uchar: 1, int8: 1, uint8: 1, short: 2, ushort: 2, int16: 2, uint16: 2 },
  ...{ int: 4, uint: 4, int32: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8 },
};

/**
 * The layout of the Gaussians of a PLY file.
 * @throws {@link Sim3AlignError} `CORRUPT_FILE`; `UNSUPPORTED_FORMAT` for other encodings, meshes, and higher harmonics
 */
export function gaussianLayout(bytes: Uint8Array): GaussianLayout {
  const header = plyHeader(bytes);
  if (header === null) throw corrupt('no "end_header" line', "the header of a PLY file");
  const words = header.text.split(/[\r\n]+/).map((line) => line.trim().split(/\s+/));
  const format = words.find(([keyword]) => keyword === "format")?.[1];
  if (format !== "binary_little_endian") {
    throw unsupported(`PLY format ${format}`, "binary_little_endian", "Write it as binary little-endian.");
  }
  const [first, second] = words.flatMap(([keyword], i) => (keyword === "element" ? [i] : []));
  const [, name, declared] = words[first ?? words.length] ?? [];
  const properties = words.slice(first, second).filter(([keyword]) => keyword === "property");
  let stride = 0;
  const offsets = new Map<string, number>();
  for (const [, type = "", property = ""] of properties) {
    const size = sizes[type];
    if (size === undefined) throw corrupt(`the type ${JSON.stringify(type)}`, "a property with a type of PLY");
    if (/^float(32)?$/.test(type)) offsets.set(property, stride);
    stride += size;
  }
  const of = (...names: string[]) => {
    const found = names.flatMap((property) => offsets.get(property) ?? []);
    return found.length === names.length ? found : null;
  };
  const [position, normal] = [of("x", "y", "z"), of("nx", "ny", "nz")];
  const [scales, rotation] = [of("scale_0", "scale_1", "scale_2"), of("rot_0", "rot_1", "rot_2", "rot_3")];
  if (name !== "vertex" || position === null || scales === null || rotation === null) {
    const expected = "vertices with float x, y, z, scale_0 to scale_2 and rot_0 to rot_3";
    throw unsupported("a PLY file without Gaussians", expected, "placeGlb and exportPly are for meshes.");
  }
  const rest = [...offsets.keys()].filter((property) => property.startsWith("f_rest_")).length;
  const harmonics = of(...Array.from({ length: rest }, (_, i) => `f_rest_${i}`));
  const degree = Math.sqrt(rest / 3 + 1) - 1;
  if (harmonics === null || !Number.isInteger(degree) || degree > MAX_DEGREE) {
    const remedy = "Export it with fewer harmonics.";
    throw unsupported(`${rest} properties f_rest`, "0, 9, 24 or 45: harmonics up to degree 3", remedy);
  }
  const start = header.end;
  const count = Number(declared);
  const available = bytes.length - start;
  if (!(Number.isSafeInteger(count) && count >= 0 && count * stride <= available)) {
    throw corrupt(`${available} bytes for ${declared} Gaussians of ${stride}`, "as many as the PLY header says");
  }
  return { start, count, stride, position, normal, scales, rotation, harmonics };
}

const corrupt = (found: string, expected: string) =>
  failure("CORRUPT_FILE", "splats", found, expected, "The file may be truncated: download or export it again.");

const unsupported = (found: string, expected: string, remedy: string) =>
  failure("UNSUPPORTED_FORMAT", "splats", found, expected, remedy);
