/** Colours of what is not data. */
import { Color } from "three/webgpu";

interface Theme {
  background: string;
  frustum: string;
  /** Points of a scene without photo, from near to far. */
  near: string;
  far: string;
}

const themes: Record<"light" | "dark", Theme> = {
  light: { background: "#eef1f5", frustum: "#7a8699", near: "#c9bfae", far: "#51698c" },
  dark: { background: "#14181f", frustum: "#67748a", near: "#d8cdba", far: "#35496b" },
};

/** A theme's colours; the background is the host's own, where it has one. */
export function colours(theme: "light" | "dark", host: HTMLElement) {
  const { background, frustum, near, far } = themes[theme];
  const own = getComputedStyle(host).backgroundColor;
  const isOpaque = /^rgb\(/.test(own);
  return {
    background: new Color(isOpaque ? own : background),
    frustum: new Color(frustum),
    near: new Color(near),
    far: new Color(far),
  };
}
