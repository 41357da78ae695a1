/** Display settings. */
import { effect, signal } from "@preact/signals";

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

export const layers = signal<ImageLayers>({
  base: "photo",
  outline: true,
  silhouette: true,
  difference: false,
  zoom: true,
  wipe: 0,
});

export const setLayer = <K extends keyof ImageLayers>(name: K, value: ImageLayers[K]): void => {
  layers.value = { ...layers.peek(), [name]: value };
};

/** Layers of the 3D view. */
export interface Display3d {
  cloud: boolean;
  mesh: boolean;
  wireframe: boolean;
  dimensions: boolean;
  pointSize: number;
}

export const display3d = signal<Display3d>({
  ...{ cloud: true, mesh: true, wireframe: false, dimensions: true },
  pointSize: 1.6,
});

export const gizmo = signal<"translate" | "rotate" | "scale" | null>(null);

/** How the handles move: along the axes of the mesh, and in steps. */
export const gizmoSettings = signal({ isLocal: false, snaps: false });

/** The points that are being measured, OpenCV camera frame, metres; null while nothing is measured. */
export const measured = signal<readonly (readonly [number, number, number])[] | null>(null);

/** Adds a point to what is measured. A third one begins anew. Returns whether anything is measured. */
export function measure(point: readonly [number, number, number]): boolean {
  const points = measured.peek();
  if (points === null) return false;
  measured.value = points.length >= 2 ? [point] : [...points, point];
  return true;
}

/** Whether the 3D view shows the poses before any alignment. */
export const showsBefore = signal(false);

/** The view that has the larger area. */
export const largeView = signal<"space" | "image">("space");

/** The pixel of the depth map under the pointer, in either view. */
export const hoveredPixel = signal<{ x: number; y: number } | null>(null);

export const isHelpOpen = signal(false);

export type Theme = "system" | "light" | "dark";

const THEME_KEY = "sim3align-theme";

function storedTheme(): Theme {
  try {
    const theme = localStorage.getItem(THEME_KEY);
    return theme === "light" || theme === "dark" ? theme : "system";
  } catch {
    // Storage may be blocked.
    return "system";
  }
}

export const theme = signal<Theme>(storedTheme());

const darkQuery = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(darkQuery.matches);
darkQuery.addEventListener("change", ({ matches }) => {
  systemIsDark.value = matches;
});

/** The theme in effect. */
export const effectiveTheme = () => (theme.value === "system" ? (systemIsDark.value ? "dark" : "light") : theme.value);

effect(() => {
  document.documentElement.style.colorScheme = theme.value === "system" ? "light dark" : theme.value;
  try {
    if (theme.value === "system") localStorage.removeItem(THEME_KEY);
    else localStorage.setItem(THEME_KEY, theme.value);
  } catch {
    // Storage is blocked: the theme is lost when the page closes.
  }
});
