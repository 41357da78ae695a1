/** The description of the view for screen readers. */
import type { Look } from "./types.js";

const lookNames: Record<Look, string> = {
  camera: "the depth camera",
  orbit: "three quarters",
  top: "above",
  side: "the side",
};

/**
 * What the view shows.
 *
 * @param points the number of points of the scene
 * @param placed the names of the meshes that have a pose
 */
export function description(from: Look, points: number, placed: readonly string[]): string {
  const meshes = placed.length === 0 ? "no mesh placed yet" : `placed meshes: ${placed.join(", ")}`;
  return `3D view from ${lookNames[from]}: ${points.toLocaleString("en-GB")} points of the scene, ${meshes}`;
}
