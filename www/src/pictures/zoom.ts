/** Zooms the image view to the objects. */
import type { Scene } from "../state/scene.js";
import { type Box, boxAround } from "./box.js";
import { drawnScene } from "./reduced.js";

/** Share of the view that the objects fill. */
const SHARE = 0.62;
/** Larger factors would show single pixels. */
const MAX_FACTOR = 8;

/** A zoom factor and the centre of the visible part, as shares of the image size. */
export interface Zoom {
  factor: number;
  x: number;
  y: number;
}

export const wholeImage: Zoom = { factor: 1, x: 0.5, y: 0.5 };

/** The zoom that shows all objects of the scene. */
export function zoomToObjects(scene: Scene): Zoom {
  const { width, height, maskBoxOf } = drawnScene(scene);
  const box = scene.objects.map(maskBoxOf).reduce<Box | null>(boxAround, null);
  if (box === null) return wholeImage;
  const factor = SHARE * Math.min(width / (box.right - box.left), height / (box.bottom - box.top));
  if (factor <= 1) return wholeImage;
  return clampedZoom({
    factor: Math.min(factor, MAX_FACTOR),
    x: (box.left + box.right) / 2 / width,
    y: (box.top + box.bottom) / 2 / height,
  });
}

/** The nearest zoom that shows nothing beyond the border of the image. */
export function clampedZoom({ factor, x, y }: Zoom): Zoom {
  const half = 0.5 / factor;
  const clamped = (centre: number) => Math.min(Math.max(centre, half), 1 - half);
  return { factor, x: clamped(x), y: clamped(y) };
}

/** Where a point of the window is in a picture, as shares of its size. */
export const shareOf = ({ left, top, width, height }: DOMRect, clientX: number, clientY: number) =>
  [(clientX - left) / width, (clientY - top) / height] as const;

/** The largest factor that a wheel or fingers reach. */
const MAX_OWN_FACTOR = 24;

/** Another zoom, in which a place of the picture stays where it is in the view. */
export function zoomedAt({ factor, x, y }: Zoom, by: number, [u, v]: readonly [number, number]): Zoom {
  const next = Math.min(Math.max(factor * by, 1), MAX_OWN_FACTOR);
  const kept = (centre: number, share: number) => share + ((centre - share) * factor) / next;
  return clampedZoom({ factor: next, x: kept(x, u), y: kept(y, v) });
}
