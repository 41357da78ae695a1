/** Several views of the test scene, from cameras on a circle around the object. */
import { viewFiles } from "./files.js";
import { type Mesh, mesh, type Pose, pinhole, poseJson, product, render, truth, type View } from "./scene.js";

const size = { width: 160, height: 120 };

/** A frame of the scene, and the true pose in it. */
export interface RigFrame {
  frame: View;
  /** World from camera; the world is the camera at 0°. */
  cameraToWorld: { scale: number; rotation: [number, number, number, number]; translation: [number, number, number] };
  pose: Pose;
}

/** The view of a camera that is turned about the object, by default the blob, by this angle in degrees. */
export function frameAt(degrees: number, object: Mesh = mesh as Mesh): RigFrame {
  const half = (degrees * Math.PI) / 360;
  const turn: Pose["rotation"] = [0, Math.sin(half), 0, Math.cos(half)];
  const pose: Pose = { ...truth, rotation: product(turn, truth.rotation) };
  const { depth, mask, camera } = render(object, pose, pinhole, size.width, size.height);
  const back: Pose["rotation"] = [0, -turn[1], 0, turn[3]];
  const [x, , z] = truth.translation;
  // c − Rᵀ·c, about the object's origin c.
  const [sin, cos] = [Math.sin(2 * half), Math.cos(2 * half)];
  const translation: [number, number, number] = [x - (cos * x - sin * z), 0, z - (sin * x + cos * z)];
  return {
    frame: { depth, ...size, mask, camera },
    cameraToWorld: { scale: 1, rotation: back, translation },
    pose,
  };
}

/** A frame with its true pose, as the files of a folder. */
export const frameFiles = ({ frame, pose }: RigFrame) => ({ ...viewFiles(frame), "gt.json": poseJson(pose) });

/** The angle between two rotations, degrees. */
export function turnBetween(a: readonly number[], b: readonly number[]): number {
  const dot = a.reduce((sum, x, i) => sum + x * (b[i] as number), 0);
  return (2 * Math.acos(Math.min(1, Math.abs(dot))) * 180) / Math.PI;
}
