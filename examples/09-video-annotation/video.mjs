/** The stand-in for a video: a depth camera that is carried around a mug, and the truth. Replace it with your own frames. */
import { readFile } from "node:fs/promises";
import { compose, invert } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";
import { capture, lookAt, MUG_UP, standing } from "../depth-camera.mjs";

export const mesh = await readMesh(await readFile(new URL("../sample/mug/mesh.glb", import.meta.url)));

/** Number of frames. */
export const FRAMES = 40;

const worldFromMesh = standing(mesh, MUG_UP, 0.1);

/** Depth, mask and intrinsics of a frame, and the true pose in it, camera from mesh. */
export function frameAt(k) {
  const heading = (2 * k * Math.PI) / 180;
  const eye = [0.5 * Math.cos(heading), 0.5 * Math.sin(heading), 0.35 + 0.05 * Math.sin(k / 8)];
  const cameraToWorld = lookAt(eye, [0.02 * Math.sin(k / 5), 0, 0.05]);
  const truth = compose(invert({ matrix: cameraToWorld }), { matrix: worldFromMesh });
  return { ...capture([{ mesh, worldFromMesh }], cameraToWorld, k + 1), truth };
}
