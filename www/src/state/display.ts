/** What is shown, and how. */
import { effect, signal } from "@preact/signals";

/** What the image view draws. */
export interface ImageLayers {
  base: "photo" | "depth";
  outline: boolean;
  silhouette: boolean;
  difference: boolean;
  /** Whether the objects fill the view, and not the whole image. */
  zoom: boolean;
  /** Where before ends and after begins, as a share of what is seen: 0 is all after, 1 all before. */
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

/** What the 3D view draws. */
export interface Display3d {
  cloud: boolean;
  mesh: boolean;
  wireframe: boolean;
  pointSize: number;
}

export const display3d = signal<Display3d>({ cloud: true, mesh: true, wireframe: false, pointSize: 1 });

export const gizmo = signal<"translate" | "rotate" | "scale" | null>(null);

/** Which of the views has the large place. */
export const largeView = signal<"space" | "image">("space");

/** The pixel of the depth map that is pointed at, in either view. */
export const pointed = signal<{ x: number; y: number } | null>(null);

export type Theme = "system" | "light" | "dark";

const kept = "sim3align-theme";

function keptTheme(): Theme {
  try {
    const theme = localStorage.getItem(kept);
    return theme === "light" || theme === "dark" ? theme : "system";
  } catch {
    // Storage may be forbidden.
    return "system";
  }
}

export const theme = signal<Theme>(keptTheme());

const darkQuery = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(darkQuery.matches);
darkQuery.addEventListener("change", ({ matches }) => {
  systemIsDark.value = matches;
});

/** Light or dark, as it is now. */
export const shownTheme = () => (theme.value === "system" ? (systemIsDark.value ? "dark" : "light") : theme.value);

effect(() => {
  document.documentElement.style.colorScheme = theme.value === "system" ? "light dark" : theme.value;
  try {
    if (theme.value === "system") localStorage.removeItem(kept);
    else localStorage.setItem(kept, theme.value);
  } catch {
    // It then lasts as long as the page.
  }
});
