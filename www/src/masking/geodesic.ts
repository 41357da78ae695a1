/** Distances along paths over a grid. */
import { STEPS } from "./walker.js";

/**
 * The length of the shortest path from a source to each pixel, over the eight neighbours.
 *
 * @param sources pixels, and the length with which a path begins there
 * @param costs the length of the step from a pixel to its neighbour, by the directions of {@link STEPS}
 */
export function distances(
  { width, height }: { width: number; height: number },
  sources: Iterable<readonly [pixel: number, length: number]>,
  costs: readonly Float64Array[],
): Float64Array {
  const found = new Float64Array(width * height).fill(Number.POSITIVE_INFINITY);
  const queue = new Heap();
  for (const [pixel, length] of sources) {
    if (length >= (found[pixel] as number)) continue;
    found[pixel] = length;
    queue.push(length, pixel);
  }
  for (let next = queue.pop(); next !== null; next = queue.pop()) {
    const [length, pixel] = next;
    if (length > (found[pixel] as number)) continue;
    const [x, y] = [pixel % width, Math.floor(pixel / width)];
    STEPS.forEach(([dx, dy], direction) => {
      for (const sign of [1, -1]) {
        const [u, v] = [x + sign * dx, y + sign * dy];
        if (u < 0 || v < 0 || u >= width || v >= height) continue;
        const other = v * width + u;
        const longer = length + (costs[direction]?.[sign > 0 ? pixel : other] as number);
        if (longer >= (found[other] as number)) continue;
        found[other] = longer;
        queue.push(longer, other);
      }
    });
  }
  return found;
}

/** A queue of pixels, the shortest first. */
class Heap {
  #keys: number[] = [];
  #values: number[] = [];

  push(key: number, value: number): void {
    const [keys, values] = [this.#keys, this.#values];
    let at = keys.length;
    keys.push(key);
    values.push(value);
    while (at > 0) {
      const parent = (at - 1) >> 1;
      if ((keys[parent] as number) <= key) break;
      keys[at] = keys[parent] as number;
      values[at] = values[parent] as number;
      at = parent;
    }
    keys[at] = key;
    values[at] = value;
  }

  pop(): [key: number, value: number] | null {
    const [keys, values] = [this.#keys, this.#values];
    const [first, value] = [keys[0], values[0]];
    if (first === undefined || value === undefined) return null;
    const key = keys.pop() as number;
    const last = values.pop() as number;
    const count = keys.length;
    if (count > 0) {
      let at = 0;
      for (;;) {
        let child = 2 * at + 1;
        if (child >= count) break;
        if (child + 1 < count && (keys[child + 1] as number) < (keys[child] as number)) child++;
        if ((keys[child] as number) >= key) break;
        keys[at] = keys[child] as number;
        values[at] = values[child] as number;
        at = child;
      }
      keys[at] = key;
      values[at] = last;
    }
    return [first, value];
  }
}
