/** Case folders, written as their users have them. */
import { join } from "node:path";
import { type Files, maskPng, npy, obj, writeFiles } from "./files.js";
import { type Mesh, mesh, type Pose, render, truth, type View } from "./scene.js";

/** What differs from case to case. */
export interface CaseOptions {
  pose?: Pose;
  /** Leaves the mask empty, which is an error. */
  isEmpty?: boolean;
}

const seen = (pose: Pose) => render(mesh as Mesh, pose, { fx: 300, fy: 301, cx: 79.5, cy: 60 }, 160, 120);

const depthAndCamera = ({ width, height, depth, camera }: View) => ({
  "depth.npy": npy(depth, height, width),
  "camera.json": { ...camera, width, height },
});

const maskFile = ({ mask, width, height }: View) => maskPng(mask, width, height);

/** Writes a case of the test scene, and returns its folder. */
export function writeCase(parent: string, name: string, { pose = truth, isEmpty = false }: CaseOptions = {}): string {
  const view = seen(pose);
  const mask = maskFile(isEmpty ? { ...view, mask: new Uint8Array(view.mask.length) } : view);
  return writeFiles(join(parent, name), { ...depthAndCamera(view), "mask.png": mask, "mesh.obj": obj(mesh) });
}

/** Writes a scene of two objects of the test scene's mesh, side by side, and returns its folder. */
export function writeScene(parent: string, name: string): string {
  const [x, y, z] = truth.translation;
  const [left, right] = [-0.1, 0.1].map((dx) => seen({ ...truth, translation: [x + dx, y, z] })) as [View, View];
  const isFree = right.depth.map((_, i) => (left.mask[i] === 0 ? 1 : 0));
  const mask = right.mask.map((value, i) => value * (isFree[i] ?? 0));
  const depth = left.depth.map((value, i) => (isFree[i] === 1 ? (right.depth[i] ?? 0) : value));
  return writeFiles(join(parent, name), {
    ...depthAndCamera({ ...left, depth }),
    ...{ "objects/left/mask.png": maskFile(left), "objects/left/mesh.obj": obj(mesh) },
    ...{ "objects/right/mask.png": maskFile({ ...right, mask }), "objects/right/mesh.obj": obj(mesh) },
  });
}

/** Writes a video in which the object moves by 4 mm per frame, with a mask in the first frame only; returns its folder. */
export function writeVideo(parent: string, name: string, frames: number): string {
  const files: Files = { "mesh.obj": obj(mesh) };
  for (let i = 0; i < frames; i++) {
    const [x, y, z] = truth.translation;
    const view = seen({ ...truth, translation: [x + 0.004 * i, y, z] });
    for (const [file, content] of Object.entries(depthAndCamera(view))) files[`frame_${i}/${file}`] = content;
    if (i === 0) files["frame_0/mask.png"] = maskFile(view);
  }
  return writeFiles(join(parent, name), files);
}

/** Poses that differ from the test scene's in place, size and turn. */
export function otherPose(i: number): Pose {
  const [x, y, z] = truth.translation;
  const half = 0.2 * i;
  const rotation: Pose["rotation"] = [0.6 * Math.sin(half), 0.8 * Math.sin(half), 0, Math.cos(half)];
  return { scale: truth.scale * (1 + 0.01 * i), rotation, translation: [x + 0.002 * i, y, z + 0.01 * i] };
}
