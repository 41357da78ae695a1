/** Which colours are those of the object: learned from a region. */
import type { Grid } from "./grid.js";

/** Levels of each of the three values of a colour. */
const LEVELS = 12;
/** What a cell that was marked counts. */
const MARKED = 3;

/** Log odds of the colour of each cell, from smoothed histograms of inside and outside. */
export function colourOdds({ colours, width, height }: Grid, soft: Float64Array, seeds: Int8Array): Float64Array {
  const count = width * height;
  const [inside, outside] = [new Float64Array(LEVELS ** 3), new Float64Array(LEVELS ** 3)];
  const level = (value: number, from: number, to: number) =>
    Math.min(LEVELS - 1, Math.max(0, Math.floor((LEVELS * (value - from)) / (to - from))));
  const bins = Int32Array.from({ length: count }, (_, i) => {
    const [brightness, first, second] = [0, 1, 2].map((k) => colours[3 * i + k] as number) as [number, number, number];
    return (level(brightness, 0, 256) * LEVELS + level(first, -96, 96)) * LEVELS + level(second, -64, 64);
  });
  let [ins, outs] = [0, 0];
  bins.forEach((bin, i) => {
    const weight = seeds[i] === 0 ? 1 : MARKED;
    if ((soft[i] as number) > 0.5) {
      inside[bin] = (inside[bin] as number) + weight;
      ins += weight;
    } else {
      outside[bin] = (outside[bin] as number) + weight;
      outs += weight;
    }
  });
  const [p, q] = [blurred(inside), blurred(outside)];
  // Colours that were never seen say nothing.
  const floor = 3 / count;
  return Float64Array.from(bins, (bin) =>
    Math.log(((p[bin] as number) / (ins || 1) + floor) / ((q[bin] as number) / (outs || 1) + floor)),
  );
}

/** A histogram, blurred by a level along each of its axes. */
function blurred(bins: Float64Array): Float64Array {
  let now = bins;
  for (const step of [1, LEVELS, LEVELS * LEVELS]) {
    const next = Float64Array.from(now, (value) => 0.5 * value);
    now.forEach((value, i) => {
      const k = Math.floor(i / step) % LEVELS;
      const [before, after] = [k > 0 ? i - step : i, k < LEVELS - 1 ? i + step : i];
      next[before] = (next[before] as number) + 0.25 * value;
      next[after] = (next[after] as number) + 0.25 * value;
    });
    now = next;
  }
  return now;
}
