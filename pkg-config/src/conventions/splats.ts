/** Placement of 3D Gaussian splats. */

import { bytesOfFile } from "../input/bytes.js";
import { foreignMesh } from "../input/foreign-meshes.js";
import { isPly, isSplatFile, plyHeader, RECORD_BYTES, rotationIn } from "../input/splat-files.js";
import type { Sim3Like } from "../types/argument-types.js";
import { failure } from "../values/error.js";
import { optionsOf, type Vector3 } from "../values/validation.js";
import { type CameraFrame, inFrame } from "./frames.js";
import { harmonicRotation, MAX_DEGREE } from "./harmonics.js";
import { quaternionOf, turned } from "./rotation.js";
import { moved, type Similarity, similarityOf } from "./similarity.js";

/**
 * Places 3D Gaussians: transforms their positions, rotations and scales, and turns their spherical harmonics, so that each
 * shows the same colours to a camera that is moved with it. Opacities and all other properties are kept.
 *
 * @param splats the bytes of the aligned file: a binary little-endian PLY of 3D Gaussian Splatting with harmonics up to
 * degree 3, or a `.splat`
 * @param transform OpenCV camera from mesh: a result of `align` for the same file
 * @param options `frame`: that of the placed splats; `"opencv"` by default, as viewers of 3D Gaussian Splatting expect
 * @returns a file of the same format
 *
 * @example
 * const bytes = placeSplats(generated, await aligner.align({ depth, mask, camera, mesh: generated }));
 * @throws {@link Sim3AlignError} `UNSUPPORTED_FORMAT` or `CORRUPT_FILE` for other bytes, `INVALID_OPTION`, and as `toSim3`
 */
export function placeSplats(
  splats: Uint8Array | ArrayBuffer,
  transform: Sim3Like,
  options: { frame?: CameraFrame | undefined } = {},
): Uint8Array {
  const { frame = "opencv" } = optionsOf(options, ["frame"]);
  const placement = inFrame("options.frame", similarityOf(transform), frame);
  const placed = Uint8Array.from(bytesOfFile("splats", splats, "the bytes of a PLY or .splat file"));
  const other = isSplatFile(placed) ? undefined : foreignMesh(placed);
  if (other !== undefined) throw unsupported(other.found, placeable, other.remedy);
  if (isPly(placed)) placePly(placed, gaussianLayout(placed), placement);
  else placeRecords(placed, placement);
  return placed;
}

/** The files that can be placed. */
const placeable = `a PLY file of Gaussians, or a .splat file: ${RECORD_BYTES} bytes for each`;

/** Offsets, in bytes, from the beginning of a Gaussian. */
interface GaussianLayout {
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
function gaussianLayout(bytes: Uint8Array): GaussianLayout {
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
    throw unsupported("a PLY file without Gaussians", expected, "exportGlb and exportPly are for meshes.");
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

function placePly(bytes: Uint8Array, layout: GaussianLayout, placement: Similarity): void {
  const view = new DataView(bytes.buffer);
  const { start, count, stride, position, normal, scales, rotation, harmonics } = layout;
  const turn = turnOf(placement);
  const grown = Math.log(placement.scale);
  const perChannel = harmonics.length / 3;
  const bands = Array.from({ length: MAX_DEGREE }, (_, i) => i + 1)
    .filter((degree) => (degree + 1) ** 2 - 1 <= perChannel)
    .map((degree) => ({ first: degree ** 2 - 1, matrix: harmonicRotation(degree, placement.rotation) }));
  for (let place = start; place < start + count * stride; place += stride) {
    const read = (offsets: readonly number[]) => offsets.map((offset) => view.getFloat32(place + offset, true));
    const write = (offsets: readonly number[], values: readonly number[]) => {
      offsets.forEach((offset, i) => {
        view.setFloat32(place + offset, values[i] ?? 0, true);
      });
    };
    write(position, moved(placement, read(position) as Vector3));
    if (normal !== null) write(normal, turned(placement.rotation, read(normal) as Vector3));
    write(
      scales,
      read(scales).map((scale) => scale + grown),
    );
    write(rotation, turn(read(rotation)));
    for (const { first, matrix } of bands) {
      for (let channel = 0; channel < 3; channel++) {
        const from = channel * perChannel + first;
        const offsets = harmonics.slice(from, from + matrix.length);
        const values = read(offsets);
        write(
          offsets,
          matrix.map((row) => row.reduce((sum, entry, j) => sum + entry * (values[j] ?? 0), 0)),
        );
      }
    }
  }
}

function placeRecords(bytes: Uint8Array, placement: Similarity): void {
  if (!isSplatFile(bytes)) {
    const remedy = "Pass the aligned file; exportGlb and exportPly are for meshes.";
    throw unsupported(`${bytes.length} bytes that are neither`, placeable, remedy);
  }
  const view = new DataView(bytes.buffer);
  const turn = turnOf(placement);
  for (let place = 0; place < bytes.length; place += RECORD_BYTES) {
    const numbers = Array.from({ length: 6 }, (_, i) => view.getFloat32(place + 4 * i, true));
    const [x = 0, y = 0, z = 0, ...scales] = numbers;
    const placed = [...moved(placement, [x, y, z]), ...scales.map((scale) => scale * placement.scale)];
    placed.forEach((number, i) => {
      view.setFloat32(place + 4 * i, number, true);
    });
    bytes.set(turn(rotationIn(bytes, place)).map(codeOf), place + RECORD_BYTES - 4);
  }
}

const codeOf = (number: number): number => Math.min(255, Math.max(0, Math.round(128 * number + 128)));

/** Multiplies quaternions w, x, y, z by the rotation from the left. */
function turnOf({ rotation }: Similarity): (quaternion: readonly number[]) => number[] {
  const [a, b, c, d] = quaternionOf(rotation);
  return ([w = 1, x = 0, y = 0, z = 0]) => [
    d * w - a * x - b * y - c * z,
    d * x + a * w + b * z - c * y,
    d * y - a * z + b * w + c * x,
    d * z + a * y - b * x + c * w,
  ];
}

const corrupt = (found: string, expected: string) =>
  failure("CORRUPT_FILE", "splats", found, expected, "The file is damaged or incomplete: download or export it again.");

const unsupported = (found: string, expected: string, remedy: string) =>
  failure("UNSUPPORTED_FORMAT", "splats", found, expected, remedy);
