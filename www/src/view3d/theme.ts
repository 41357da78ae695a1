/** Colours of the 3D view. */
import { Color } from "./three.js";

interface Theme {
  background: string;
  frustum: string;
  /** Colours of the points of a scene without a photo. */
  near: string;
  far: string;
}

const themes: Record<"light" | "dark", Theme> = {
  light: { background: "#eef1f5", frustum: "#7a8699", near: "#c9bfae", far: "#51698c" },
  dark: { background: "#14181f", frustum: "#67748a", near: "#d8cdba", far: "#35496b" },
};

/** The colours of a theme. The background is that of the host, if it is opaque. */
export function colours(theme: "light" | "dark", host: HTMLElement) {
  const { background, frustum, near, far } = themes[theme];
  const hostColour = getComputedStyle(host).backgroundColor;
  const isOpaque = /^rgb\(/.test(hostColour);
  return {
    background: new Color(isOpaque ? hostColour : background),
    frustum: new Color(frustum),
    near: new Color(near),
    far: new Color(far),
  };
}
