/** Boxes around shapes in images. */

/** The first and last columns and rows, in pixels; `right` and `bottom` are beyond the box. */
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** The box around all pixels that are not 0; null if there is none. */
export function boxOf(shape: ArrayLike<number>, width: number): Box | null {
  let [left, top, right, bottom] = [width, -1, 0, 0];
  for (let row = 0; row * width < shape.length; row++) {
    const start = row * width;
    let first = 0;
    while (first < width && shape[start + first] === 0) first++;
    if (first === width) continue;
    let last = width - 1;
    while (shape[start + last] === 0) last--;
    if (top < 0) top = row;
    bottom = row + 1;
    left = Math.min(left, first);
    right = Math.max(right, last + 1);
  }
  return top < 0 ? null : { left, top, right, bottom };
}

/** The box around two boxes. */
export function boxAround(a: Box | null, b: Box | null): Box | null {
  if (a === null || b === null) return a ?? b;
  return {
    left: Math.min(a.left, b.left),
    top: Math.min(a.top, b.top),
    right: Math.max(a.right, b.right),
    bottom: Math.max(a.bottom, b.bottom),
  };
}
