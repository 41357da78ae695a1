/** Takes parts out of the view. */
import type { BufferGeometry, Material, Object3D, Texture } from "three/webgpu";

/** Removes an object, and frees its graphics memory. */
export function release(
  object: (Object3D & { geometry: BufferGeometry; material: Material }) | null | undefined,
): void {
  if (!object) return;
  object.removeFromParent();
  // All sprites share one geometry.
  if (object.type !== "Sprite") object.geometry.dispose();
  (object.material as { map?: Texture | null }).map?.dispose();
  object.material.dispose();
}
