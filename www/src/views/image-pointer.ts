/** What pointer and wheel do in the image view: read, select, drag and zoom. */
import { clampedZoom, shareOf, type Zoom, zoomedAt } from "../pictures/zoom.js";
import type { Scene } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import { imageOf } from "./image.js";

type Pixel = { x: number; y: number };

/** Smaller movements are clicks, in CSS pixels. */
const CLICK_PX = 4;

/** The handlers of a workspace. */
export function pointerOf(workspace: Workspace) {
  const { hoveredPixel, objectAt, scene, select, space } = workspace;
  const { ownZoom, zoom } = imageOf(workspace);

  /** Where a drag began; whether the pointer has moved since. */
  let dragFrom: { clientX: number; clientY: number; zoom: Zoom } | null = null;
  let hasDragged = false;

  function startDrag({ clientX, clientY }: PointerEvent): void {
    hasDragged = false;
    dragFrom = { clientX, clientY, zoom: zoom.peek() };
  }

  /** Moves the part of the image that is shown. */
  function drag(event: PointerEvent): void {
    if (dragFrom === null || dragFrom.zoom.factor <= 1) return;
    const [dx, dy] = [event.clientX - dragFrom.clientX, event.clientY - dragFrom.clientY];
    if (!hasDragged && Math.hypot(dx, dy) < CLICK_PX) return;
    hasDragged = true;
    const { width, height } = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
    const { factor, x, y } = dragFrom.zoom;
    ownZoom.value = clampedZoom({ factor, x: x - dx / width, y: y - dy / height });
  }

  /** Zooms at the pointer. */
  function wheel(event: WheelEvent): void {
    event.preventDefault();
    const box = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
    const at = shareOf(box, event.clientX, event.clientY);
    ownZoom.value = zoomedAt(zoom.peek(), Math.exp(-0.0015 * event.deltaY), at);
  }

  /** Selects the clicked object, and centres the 3D view on the clicked point. */
  function focusOn(event: MouseEvent): void {
    const [pixel, state] = [pixelOf(scene.peek(), event), space.peek()];
    if (pixel === null || hasDragged) return;
    const point = pointAt(scene.peek(), pixel);
    select(objectAt(pixel.x, pixel.y)?.id ?? null);
    if (state.kind === "ready" && point !== null) state.view.focus(point);
  }

  /** Marks a pixel in both views. */
  function hover(pixel: Pixel | null): void {
    hoveredPixel.value = pixel;
    const state = space.peek();
    if (state.kind === "ready") state.view.markPoint(pixel === null ? null : pointAt(scene.peek(), pixel));
  }

  return {
    focusOn,
    startDrag,
    wheel,
    hover,
    /** Reads the pixel under the pointer or, with a button pressed, drags the image. */
    move: (event: PointerEvent) => (event.buttons === 0 ? hover(pixelOf(scene.peek(), event)) : drag(event)),
  };
}

/** The pixel of the scene under the pointer. */
function pixelOf(whole: Scene | null, event: MouseEvent): Pixel | null {
  if (whole === null) return null;
  const { left, top, width, height } = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
  const x = Math.floor(((event.clientX - left) * whole.width) / width);
  const y = Math.floor(((event.clientY - top) * whole.height) / height);
  return x >= 0 && y >= 0 && x < whole.width && y < whole.height ? { x, y } : null;
}

/** The back-projected depth reading of a pixel: camera frame, metres. */
function pointAt(whole: Scene | null, { x, y }: Pixel): [number, number, number] | null {
  const z = whole?.depthM[y * whole.width + x] ?? 0;
  if (whole === null || !(z > 0)) return null;
  const { fx, fy, cx, cy } = whole.camera;
  return [((x - cx) * z) / fx, ((y - cy) * z) / fy, z];
}
