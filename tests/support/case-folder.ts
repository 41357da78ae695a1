/** Case folders, written as their users have them. */
import { join } from "node:path";
import { obj, viewFiles, writeFiles } from "./files.js";
import { mesh, type Pose, pinhole, render, truth } from "./scene.js";

/** Writes a case of the test scene, and returns its folder; an empty mask is an error. */
export function writeCase(parent: string, name: string, { pose = truth, isEmpty = false } = {}): string {
  const view = render(mesh, pose, pinhole, 160, 120);
  if (isEmpty) view.mask.fill(0);
  return writeFiles(join(parent, name), { ...viewFiles(view), "mesh.obj": obj(mesh) });
}

/** Poses that differ from the test scene's in place, size and turn. */
export function otherPose(i: number): Pose {
  const [x, y, z] = truth.translation;
  const half = 0.2 * i;
  const rotation: Pose["rotation"] = [0.6 * Math.sin(half), 0.8 * Math.sin(half), 0, Math.cos(half)];
  return { scale: truth.scale * (1 + 0.01 * i), rotation, translation: [x + 0.002 * i, y, z + 0.01 * i] };
}
