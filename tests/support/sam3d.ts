/** The output of SAM 3D Objects, made independently of the package. */
import { Matrix4, Quaternion } from "three";
import type { Files } from "./files.js";
import { type Pinhole, type Pose, rotationRows } from "./scene.js";

/** Input and output of the model: an object with its true pose from the vertices of its GLB. */
export interface Sam3dView {
  depth: Float32Array;
  width: number;
  height: number;
  camera: Pinhole;
}

/** `output["pointmap"]`: x left, y up, z forward; or, of other tools, x right, y down. Infinite without reading. */
export function pointMap({ depth, width, camera }: Sam3dView, side: 1 | -1 = -1): Float32Array {
  const points = new Float32Array(3 * depth.length);
  depth.forEach((z, i) => {
    const x = (((i % width) - camera.cx) / camera.fx) * z;
    const y = ((Math.floor(i / width) - camera.cy) / camera.fy) * z;
    points.set(z > 0 ? [side * x, side * y, z] : [Infinity, Infinity, Infinity], 3 * i);
  });
  return points;
}

/** The map as `numpy.save` writes it. */
export function pointMapNpy(view: Sam3dView, side?: 1 | -1): Uint8Array {
  const points = pointMap(view, side);
  const dict = `{'descr': '<f4', 'fortran_order': False, 'shape': (${view.height}, ${view.width}, 3), }`;
  const start = Buffer.from(`\x93NUMPY\x01\x00\x76\x00${dict.padEnd(117)}\n`, "latin1");
  return Buffer.concat([start, Buffer.from(points.buffer)]);
}

/**
 * The layout that puts the vertices of a GLB at a pose (OpenCV camera): p′ = (p·S)·R + t on rows of z-up vertices, x left and
 * y up, as `tolist()` writes it.
 */
export function layoutOf({ scale, rotation, translation }: Pose, scales: readonly number[] = [1, 1, 1]) {
  const rows = rotationRows(rotation);
  // The axes of the GLB's vertices by those with z up: x, z, −y. Then the two axes of the camera that are turned.
  const turned = rows.map(([x, y, z]) => [x, -z, y]);
  const [a = [], b = [], c = []] = [turned[0]?.map((x) => -x), turned[1]?.map((x) => -x), turned[2]];
  // Rows times R is the transpose times columns.
  const matrix = new Matrix4().set(
    ...([a[0], b[0], c[0], 0, a[1], b[1], c[1], 0, a[2], b[2], c[2], 0, 0, 0, 0, 1] as Parameters<Matrix4["set"]>),
  );
  const { x, y, z, w } = new Quaternion().setFromRotationMatrix(matrix);
  return {
    rotation: [[w, x, y, z]],
    translation: [[-translation[0], -translation[1], translation[2]]],
    scale: [scales.map((one) => scale * one)],
  };
}

/** A point of a GLB in the frame of the Gaussians. */
export const zUp = ([x = 0, y = 0, z = 0]: readonly number[]) => [x, -z, y];

/** An object of an output. */
export interface Sam3dObject {
  name: string;
  /** The bytes of a PNG. */
  mask: Uint8Array;
  glb: Uint8Array;
  /** The pose by the model. */
  pose: Pose;
}

/** The folder of an output, as the guide describes it. */
export function sam3dFiles(view: Sam3dView, objects: readonly Sam3dObject[], more: Files = {}): Files {
  const files: Files = { "pointmap.npy": pointMapNpy(view), ...more };
  for (const { name, mask, glb, pose } of objects) {
    const own = { "mask.png": mask, "mesh.glb": glb, "pose.json": layoutOf(pose) };
    for (const [file, content] of Object.entries(own)) files[`objects/${name}/${file}`] = content;
  }
  return files;
}
