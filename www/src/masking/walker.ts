/** The random walker on a grid of pixels: soft regions that follow edges. No part of it refers to the browser. */

/** Weights between neighbours, row-major: of each pixel with those to its right, below, below right and below left. */
export interface Edges {
  width: number;
  height: number;
  weights: readonly [right: Float64Array, down: Float64Array, downRight: Float64Array, downLeft: Float64Array];
}

/** The steps to the neighbours of {@link Edges}, in its order. */
export const STEPS = [
  [1, 0],
  [0, 1],
  [1, 1],
  [-1, 1],
] as const;

/** Calls `use` for each pair of neighbours, with the index of their weight. */
export function eachPair(
  { width, height }: { width: number; height: number },
  use: (a: number, b: number, direction: number) => void,
): void {
  STEPS.forEach(([dx, dy], direction) => {
    const [left, right] = [Math.max(0, -dx), width - Math.max(0, dx)];
    for (let y = 0; y < height - dy; y++) {
      for (let x = left; x < right; x++) use(y * width + x, (y + dy) * width + x + dx, direction);
    }
  });
}

/**
 * The x that minimise Σ w (x_i − x_j)² over pairs of neighbours plus Σ trust (x_i − prior_i)² over pixels, by conjugate
 * gradients. All x are between the least and the greatest prior.
 *
 * @param start where the search begins
 * @param tolerance of the residual, relative to that of 0
 */
export function walked(
  edges: Edges,
  prior: Float64Array,
  trust: Float64Array,
  start: Float64Array = prior,
  tolerance = 1e-3,
): Float64Array {
  const { width, height, weights } = edges;
  const count = width * height;
  const diagonal = Float64Array.from(trust);
  eachPair(edges, (a, b, direction) => {
    const w = weights[direction]?.[a] ?? 0;
    diagonal[a] = (diagonal[a] as number) + w;
    diagonal[b] = (diagonal[b] as number) + w;
  });
  const times = (x: Float64Array, out: Float64Array) => {
    for (let i = 0; i < count; i++) out[i] = (diagonal[i] as number) * (x[i] as number);
    STEPS.forEach(([dx, dy], direction) => {
      const w = weights[direction] as Float64Array;
      const step = dy * width + dx;
      const [left, right] = [Math.max(0, -dx), width - Math.max(0, dx)];
      for (let y = 0; y < height - dy; y++) {
        for (let a = y * width + left, end = y * width + right; a < end; a++) {
          const b = a + step;
          const own = w[a] as number;
          out[a] = (out[a] as number) - own * (x[b] as number);
          out[b] = (out[b] as number) - own * (x[a] as number);
        }
      }
    });
  };
  const dot = (a: Float64Array, b: Float64Array) => {
    let sum = 0;
    for (let i = 0; i < count; i++) sum += (a[i] as number) * (b[i] as number);
    return sum;
  };
  const x = Float64Array.from(start);
  const [r, z, p, q] = [0, 1, 2, 3].map(() => new Float64Array(count)) as [
    Float64Array,
    Float64Array,
    Float64Array,
    Float64Array,
  ];
  times(x, q);
  let scale = 0;
  for (let i = 0; i < count; i++) {
    const right = (trust[i] as number) * (prior[i] as number);
    r[i] = right - (q[i] as number);
    scale += right * right;
  }
  const precondition = () => {
    for (let i = 0; i < count; i++) z[i] = (r[i] as number) / ((diagonal[i] as number) || 1);
  };
  precondition();
  p.set(z);
  let rz = dot(r, z);
  for (let step = 0; step < MAX_STEPS && dot(r, r) > tolerance * tolerance * scale; step++) {
    times(p, q);
    const length = rz / (dot(p, q) || 1);
    for (let i = 0; i < count; i++) {
      x[i] = (x[i] as number) + length * (p[i] as number);
      r[i] = (r[i] as number) - length * (q[i] as number);
    }
    precondition();
    const next = dot(r, z);
    const turn = next / (rz || 1);
    rz = next;
    for (let i = 0; i < count; i++) p[i] = (z[i] as number) + turn * (p[i] as number);
  }
  return x;
}

/** More are not needed at the sizes of the mask tool. */
const MAX_STEPS = 400;
