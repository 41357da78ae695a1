/** Random cases from a seed, and comparisons of numbers. */
import assert from "node:assert/strict";
import type { Pose } from "./scene.js";

/** Numbers from 0 to 1, the same for the same seed: mulberry32. */
export class Random {
  #state: number;

  constructor(seed: number) {
    this.#state = seed >>> 0;
  }

  /** From `low` to `high`. */
  between(low: number, high: number): number {
    this.#state = (this.#state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(this.#state ^ (this.#state >>> 15), 1 | this.#state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return low + ((high - low) * ((t ^ (t >>> 14)) >>> 0)) / 2 ** 32;
  }

  /** A whole number from `low` to `high`. */
  whole(low: number, high: number): number {
    return Math.floor(this.between(low, high + 1));
  }

  /** That many numbers. */
  list(count: number, low: number, high: number): number[] {
    return Array.from({ length: count }, () => this.between(low, high));
  }

  /** A pose of any rotation; some are half turns, whose quaternions have w = 0. */
  pose(): Pose {
    const direction = this.list(4, -1, 1) as Pose["rotation"];
    if (this.between(0, 1) < 0.2) direction[3] = 0;
    const length = Math.hypot(...direction) * (direction[3] < 0 ? -1 : 1);
    return {
      scale: 10 ** this.between(-2, 2),
      rotation: direction.map((q) => q / length) as Pose["rotation"],
      translation: this.list(3, -3, 3) as Pose["translation"],
    };
  }
}

/** Runs a check for several seeds, and names the seed that fails. */
export function forSeeds(count: number, check: (random: Random, seed: string) => void): void {
  for (let seed = 1; seed <= count; seed++) check(new Random(seed), `seed ${seed}`);
}

/** Whether numbers are equal up to rounding. */
export function assertNear(
  actual: ArrayLike<number>,
  expected: ArrayLike<number>,
  message: string,
  tolerance = 1e-9,
): void {
  assert.equal(actual.length, expected.length, `${message}: length`);
  const size = Math.max(1, ...Array.from(expected, Math.abs));
  for (let i = 0; i < expected.length; i++) {
    const off = Math.abs((actual[i] ?? Number.NaN) - (expected[i] ?? Number.NaN));
    assert.ok(off <= tolerance * size, `${message}: [${i}] is ${actual[i]}, expected ${expected[i]}`);
  }
}
