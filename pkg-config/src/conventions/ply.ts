/** Export of meshes as PLY files. */

import type { Sim3Like } from "../input/sim3.js";
import type { MeshArrays } from "../types/inputs.js";
import { meshOf, triangleCount } from "./mesh.js";
import { applyToPoints } from "./similarity.js";

/**
 * Exports a mesh as a binary little-endian PLY file with `float` x, y, z and `int` vertex_indices, which Open3D,
 * MeshLab, CloudCompare and Blender read.
 *
 * @param mesh `positions` and `indices`
 * @param transform applied to the vertices: a result of `align` for metres in the OpenCV camera frame, or
 * `toFrame(result, "opengl")`, for example, for another frame; by default, vertices are unchanged
 *
 * @example
 * await writeFile("placed.ply", exportPly(mesh, result));
 * @throws {@link Sim3AlignError} for an invalid mesh or transform
 */
export function exportPly(mesh: MeshArrays, transform?: Sim3Like): Uint8Array {
  const checked = meshOf("mesh", mesh);
  const positions = transform === undefined ? checked.positions : applyToPoints(transform, checked.positions);
  const faces = triangleCount(checked);
  const lines = [
    ...["ply", "format binary_little_endian 1.0", "comment sim3align", `element vertex ${positions.length / 3}`],
    ...["property float x", "property float y", "property float z"],
    ...[`element face ${faces}`, "property list uchar int vertex_indices", "end_header", ""],
  ];
  const header = new TextEncoder().encode(lines.join("\n"));
  const file = new Uint8Array(header.length + 4 * positions.length + 13 * faces);
  file.set(header);
  const view = new DataView(file.buffer);
  positions.forEach((x, i) => {
    view.setFloat32(header.length + 4 * i, x, true);
  });
  let place = header.length + 4 * positions.length;
  for (let i = 0; i < 3 * faces; i++) {
    if (i % 3 === 0) view.setUint8(place++, 3);
    view.setInt32(place, checked.indices === null ? i : (checked.indices[i] ?? 0), true);
    place += 4;
  }
  return file;
}
