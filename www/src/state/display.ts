/** Display settings. */
import { signal } from "@preact/signals";

/** Layers of the image view. */
export interface ImageLayers {
  base: "photo" | "depth";
  outline: boolean;
  silhouette: boolean;
  difference: boolean;
  /** Whether the view is zoomed to the objects. */
  zoom: boolean;
  /** The share of the visible width that shows the start poses, from the left: 0 is all after, 1 is all before. */
  wipe: number;
}

/** Layers of the 3D view. */
export interface Display3d {
  cloud: boolean;
  mesh: boolean;
  wireframe: boolean;
  dimensions: boolean;
  /** Whether there are views from above, from the side and from the front. */
  planes: boolean;
  pointSize: number;
}

/** The state of the display. */
export function displayState() {
  const layers = signal<ImageLayers>({
    base: "photo",
    outline: true,
    silhouette: true,
    difference: false,
    zoom: true,
    wipe: 0,
  });

  const setLayer = <K extends keyof ImageLayers>(name: K, value: ImageLayers[K]): void => {
    layers.value = { ...layers.peek(), [name]: value };
  };

  const display3d = signal<Display3d>({
    ...{ cloud: true, mesh: true, wireframe: false, dimensions: true, planes: false },
    pointSize: 1.6,
  });

  const gizmo = signal<"translate" | "rotate" | "scale" | null>(null);

  /** How the handles move: along the axes of the mesh, and in steps. */
  const gizmoSettings = signal({ isLocal: false, snaps: false });

  /** Whether the 3D view shows the poses before any alignment. */
  const showsBefore = signal(false);

  /** The view that has the larger area. */
  const largeView = signal<"space" | "image">("space");

  /** The pixel of the depth map under the pointer, in either view. */
  const hoveredPixel = signal<{ x: number; y: number } | null>(null);

  return {
    ...{ layers, setLayer, display3d, gizmo, gizmoSettings },
    ...{ showsBefore, largeView, hoveredPixel },
  };
}

export type DisplayState = ReturnType<typeof displayState>;
