/** Hides and frees parts of the view. */
import type { BufferGeometry, Material, Object3D, Texture } from "three/webgpu";

/** Runs a function while these objects are not visible. */
export function whileHidden(objects: readonly Object3D[], act: () => void): void {
  const before = objects.map(({ visible }) => visible);
  for (const object of objects) object.visible = false;
  act();
  for (const [i, object] of objects.entries()) object.visible = before[i] === true;
}

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
