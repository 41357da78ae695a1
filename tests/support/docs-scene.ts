/**
 * What the documentation's examples may use without having made it: a scene of 640 × 480 pixels, what was found in it,
 * and names that stand for values of the reader's own. Each is a global variable in an example.
 */
import { createAligner } from "sim3align";
import { resizeInput } from "sim3align/conventions";
import { Object3D, PerspectiveCamera } from "three";
import { greyJpeg, tiff } from "./exif.js";
import { glb } from "./files.js";
import { mesh, truth, view } from "./scene.js";

const size = { width: 640, height: 480 };
const old = { width: view.width, height: view.height };
const resized = resizeInput(
  { depth: { data: view.depth, ...old }, mask: { data: view.mask, ...old }, camera: view.camera },
  size,
);
const { camera } = resized;
const [depth, mask] = [resized.depth.data, resized.mask.data];
const { fx, fy, cx, cy } = camera;
const { width, height } = size;
const input = { depth, width, height, mask, camera, mesh };

/** The bytes of a photo of this camera: 65 mm on full frame, resized by a quarter. */
const photo = greyJpeg(tiff({}, { focal35: 65, pixelX: 4 * width, pixelY: 4 * height }, true), width, height);
/** The output of a model of relative depth. */
const relative = { data: depth.map((z) => 2 / z + 0.3), width, height };

const aligner = await createAligner();
const result = await aligner.align(input);
const { scale, rotation, translation } = result;
const [x, y, z, w] = rotation;

/** The globals, by name. */
export const docsScene = {
  createAligner,
  aligner,
  ...{ input, depth, width, height, mask, camera, fx, fy, cx, cy, mesh, photo, relative },
  /** The bytes of a GLB file of the mesh. */
  glb: glb(mesh),
  result,
  truth,
  ...{ scale, rotation, translation, x, y, z, w },
  /** An object of three.js, and one of its cameras. */
  object3d: new Object3D(),
  threeCamera: new PerspectiveCamera(),
};
