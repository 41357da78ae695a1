/** Case folders, written as their users have them. */
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { npy, obj, png } from "./files.js";
import { type Mesh, mesh, type Pose, render, truth } from "./scene.js";

/** What differs from case to case. */
export interface CaseOptions {
  pose?: Pose;
  /** Leaves the mask empty, which is an error. */
  isEmpty?: boolean;
}

/** Writes a case of the test scene, and returns its folder. */
export function writeCase(parent: string, name: string, { pose = truth, isEmpty = false }: CaseOptions = {}): string {
  const folder = join(parent, name);
  mkdirSync(folder, { recursive: true });
  const pinhole = { fx: 300, fy: 301, cx: 79.5, cy: 60 };
  const { width, height, depth, mask, camera } = render(mesh as Mesh, pose, pinhole, 160, 120);
  const write = (file: string, content: Uint8Array | string) => writeFileSync(join(folder, file), content);
  write("depth.npy", npy(depth, height, width));
  write("mask.png", png(isEmpty ? new Uint8Array(mask.length) : mask.map((value) => 255 * value), width, height));
  write("camera.json", JSON.stringify({ ...camera, width, height }));
  write("mesh.obj", obj(mesh));
  return folder;
}

/** Poses that differ from the test scene's in place, size and turn. */
export function otherPose(i: number): Pose {
  const [x, y, z] = truth.translation;
  const half = 0.2 * i;
  const rotation: Pose["rotation"] = [0.6 * Math.sin(half), 0.8 * Math.sin(half), 0, Math.cos(half)];
  return { scale: truth.scale * (1 + 0.01 * i), rotation, translation: [x + 0.002 * i, y, z + 0.01 * i] };
}
