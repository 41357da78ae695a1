/** Placement of 3D Gaussian splats. */

import { isPly, isSplatFile, RECORD_BYTES, rotationIn } from "../formats/splat-files.js";
import type { Sim3Like } from "../input/sim3.js";
import { failure, type Sim3AlignError } from "../values/error.js";
import { optionsOf, type Vector3 } from "../values/values.js";
import { bytesOfFile } from "./file-bytes.js";
import { type CameraFrame, inFrame } from "./frames.js";
import { harmonicRotation, MAX_DEGREE } from "./harmonics.js";
import { quaternionOf, turned } from "./rotation.js";
import { moved, type Similarity, similarityOf } from "./similarity.js";
import { type GaussianLayout, gaussianLayout } from "./splat-ply.js";

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
  const { frame = "opencv" } = optionsOf(options);
  const placement = inFrame("options.frame", similarityOf(transform), frame);
  const placed = Uint8Array.from(bytesOfFile("splats", splats, "the bytes of a PLY or .splat file"));
  if (isPly(placed)) placePly(placed, gaussianLayout(placed), placement);
  else placeRecords(placed, placement);
  return placed;
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
  if (!isSplatFile(bytes)) throw notSplats(bytes);
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

const notSplats = ({ length }: Uint8Array): Sim3AlignError =>
  failure(
    "UNSUPPORTED_FORMAT",
    "splats",
    `${length} bytes that are neither`,
    `a PLY file of Gaussians, or a .splat file: ${RECORD_BYTES} bytes for each`,
    "Pass the aligned file; placeGlb and exportPly are for meshes.",
  );

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
