/** Hides parts of the view for a moment. */
import type { Object3D } from "three/webgpu";

/** Runs a function while these objects are not visible. */
export function whileHidden(objects: readonly Object3D[], act: () => void): void {
  const before = objects.map(({ visible }) => visible);
  for (const object of objects) object.visible = false;
  act();
  for (const [i, object] of objects.entries()) object.visible = before[i] === true;
}
