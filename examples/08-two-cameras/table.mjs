/** The stand-in for two depth cameras over a table: what they see, and the truth. Replace it with your own cameras. */
import { readFile } from "node:fs/promises";
import { readMesh } from "sim3align/formats";
import { capture, lookAt, MUG_UP, standing } from "../depth-camera.mjs";

export const mesh = await readMesh(await readFile(new URL("../sample/mug/mesh.glb", import.meta.url)));

/** World from mesh. */
export const truth = standing(mesh, MUG_UP, 0.1);

/** World from camera. They look from directions that are about a quarter turn apart. */
export const cameras = [lookAt([0.45, 0.1, 0.4], [0, 0, 0.05]), lookAt([-0.1, 0.5, 0.3], [0, 0, 0.05])];

/** Depth, mask and intrinsics of each. */
export const frames = cameras.map((cameraToWorld, k) =>
  capture([{ mesh, worldFromMesh: truth }], cameraToWorld, k + 1),
);
