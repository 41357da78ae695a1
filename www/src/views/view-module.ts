/** The 3D view's chunk, which holds the 3D library: loaded when everything else is there. */
import type { ObjectInput, SceneInput, View } from "./view-interface.js";

export type { ObjectInput, SceneInput, View };

interface ViewModule {
  createView(
    host: HTMLElement,
    events: {
      onPose(id: string, pose: Float64Array, phase: "drag" | "end"): void;
      onSelect(id: string | null): void;
      onHover?(pixel: { x: number; y: number } | null): void;
    },
    options?: { forceWebGL?: boolean },
  ): Promise<View>;
}

const chunks = import.meta.glob<ViewModule>("../view3d/index.ts");

export async function loadViewModule(): Promise<ViewModule> {
  const load = chunks["../view3d/index.ts"];
  if (load === undefined) throw new Error("This build has no 3D view.");
  return load();
}
