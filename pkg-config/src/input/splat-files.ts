/** Detection of files of 3D Gaussians. */

/** Bytes of a Gaussian in a `.splat` file: position and scales (six floats), colour, opacity, rotation (w, x, y, z). */
export const RECORD_BYTES = 32;

/** Number of Gaussians by which a `.splat` file is recognised. */
const CHECKED = 256;

/** The largest header of a PLY file that is looked at. */
const MAX_HEADER = 65_536;

const latin = (bytes: Uint8Array) => new TextDecoder("latin1").decode(bytes);

/** Whether a file is a PLY. */
export const isPly = (bytes: Uint8Array): boolean => /^ply[\r\n]/.test(latin(bytes.subarray(0, 4)));

/** The header of a PLY file, and the first byte after it; `null` if it has no end. */
export function plyHeader(bytes: Uint8Array): { text: string; end: number } | null {
  const text = latin(bytes.subarray(0, MAX_HEADER));
  const found = /(^|[\r\n])end_header(\r\n|\n|\r)/.exec(text);
  return found === null ? null : { text: text.slice(0, found.index), end: found.index + found[0].length };
}

/** Whether a mesh file of this format, if it is known, holds 3D Gaussians. */
export function holdsGaussians(bytes: Uint8Array, format: unknown): boolean {
  if (format === "splat") return true;
  const mayBe = (other: string) => format === undefined || format === null || format === other;
  if (isPly(bytes)) {
    const header = mayBe("ply") ? (plyHeader(bytes)?.text ?? "") : "";
    const has = (name: string) => new RegExp(`\\s${name}\\s`).test(`${header}\n`);
    return has("packed_position") || ["f_dc_0", "opacity", "scale_0", "rot_0"].every(has);
  }
  return mayBe("splat") && isSplatFile(bytes);
}

/** Whether these bytes can be a `.splat` file: it has no signature, but its quaternions have length 1. */
export function isSplatFile(bytes: Uint8Array): boolean {
  if (bytes.length === 0 || bytes.length % RECORD_BYTES !== 0) return false;
  const end = Math.min(bytes.length, CHECKED * RECORD_BYTES);
  for (let place = 0; place < end; place += RECORD_BYTES) {
    const norm = rotationIn(bytes, place).reduce((sum, x) => sum + x * x, 0);
    if (Math.abs(norm - 1) > 0.1) return false;
  }
  return true;
}

/** The rotation, w, x, y, z, of the Gaussian of a `.splat` file that begins at `place`. */
export const rotationIn = (bytes: Uint8Array, place: number): number[] =>
  Array.from(bytes.subarray(place + RECORD_BYTES - 4, place + RECORD_BYTES), (code) => (code - 128) / 128);
