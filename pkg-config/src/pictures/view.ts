/** Views: parts of an image, enlarged or reduced. */
import type { Pinhole } from "../camera/pinhole.js";

/** A rectangle in pixels of the depth map: its corner at the edge of a pixel, and its size. */
export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** A part of the image, enlarged or reduced. */
export class View {
  /** @param zoom pixels of the view per pixel of the depth map */
  constructor(
    readonly width: number,
    readonly height: number,
    readonly zoom: number,
    /** The corner of the view, in pixels of the depth map from the corner of its image. */
    readonly left: number,
    readonly top: number,
  ) {}

  /** All of an image of this size, enlarged by a factor. */
  static whole(width: number, height: number, zoom: number): View {
    return new View(Math.round(width * zoom), Math.round(height * zoom), zoom, 0, 0);
  }

  /** The surroundings of a shape, whose box `margin` times fits. */
  static around(shape: Box, width: number, height: number, margin: number): View {
    const zoom = Math.min(width / shape.width, height / shape.height) / margin;
    const left = shape.left + shape.width / 2 - width / zoom / 2;
    const top = shape.top + shape.height / 2 - height / zoom / 2;
    return new View(width, height, zoom, left, top);
  }

  /** The camera of the view, of that of the depth map. */
  camera({ fx, fy, cx, cy }: Pinhole): Pinhole {
    const { zoom, left, top } = this;
    return {
      ...{ fx: fx * zoom, fy: fy * zoom },
      ...{ cx: (cx + 0.5 - left) * zoom - 0.5, cy: (cy + 0.5 - top) * zoom - 0.5 },
    };
  }

  /** Values of an image of the size of the depth map, each of the nearest pixel; 0 outside. */
  sampled(values: ArrayLike<number>, width: number, height: number): Float32Array {
    const result = new Float32Array(this.width * this.height);
    for (let y = 0; y < this.height; y++) {
      for (let x = 0; x < this.width; x++) {
        const u = Math.round(this.left + (x + 0.5) / this.zoom - 0.5);
        const v = Math.round(this.top + (y + 0.5) / this.zoom - 0.5);
        if (u >= 0 && v >= 0 && u < width && v < height) result[y * this.width + x] = values[v * width + u] as number;
      }
    }
    return result;
  }
}

/** The box around the pixels of an image that are not 0; `undefined` if there are none. */
export function boxOf(values: ArrayLike<number>, width: number, height: number): Box | undefined {
  let [left, top, right, bottom] = [width, height, 0, 0];
  for (let v = 0; v < height; v++) {
    for (let u = 0; u < width; u++) {
      if (!values[v * width + u]) continue;
      if (u < left) left = u;
      if (u >= right) right = u + 1;
      if (v < top) top = v;
      bottom = v + 1;
    }
  }
  return right > left ? { left, top, width: right - left, height: bottom - top } : undefined;
}

/** The box around several boxes, of which one is known at least. */
export function unionOf(boxes: readonly (Box | undefined)[], otherwise: Box): Box {
  const known = boxes.filter((box) => box !== undefined);
  if (known.length === 0) return otherwise;
  const [left, top] = [Math.min(...known.map((box) => box.left)), Math.min(...known.map((box) => box.top))];
  const right = Math.max(...known.map((box) => box.left + box.width));
  const bottom = Math.max(...known.map((box) => box.top + box.height));
  return { left, top, width: right - left, height: bottom - top };
}
