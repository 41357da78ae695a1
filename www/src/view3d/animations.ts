/** Poses that move to others. */
import type { Vector3 } from "three/webgpu";
import { between, eased, matrixOf, poseOf } from "./pose.js";
import type { Animation, Matrix } from "./types.js";

interface Movement {
  at(share: number): Float64Array;
  started: number;
  durationMs: number;
  apply(pose: Matrix): void;
  target: Matrix;
  finish(): void;
}

/** What moves at present, by name; a new movement of the same name ends the one before. */
export class Movements {
  private readonly running = new Map<string, Movement>();

  /** Moves something; resolves when it has arrived, or something else was wanted of it. */
  start(
    name: string,
    { from, durationMs }: Animation,
    target: Matrix,
    centre: Vector3,
    apply: (pose: Matrix) => void,
  ): Promise<void> {
    this.stop(name);
    const [first, last] = [poseOf(from), poseOf(target)];
    const at = (share: number) => matrixOf(between(first, last, eased(share), centre));
    apply(from);
    return new Promise((finish) => {
      this.running.set(name, { at, started: performance.now(), durationMs, apply, target, finish });
    });
  }

  /** Leaves something where it is. */
  stop(name: string): void {
    this.running.get(name)?.finish();
    this.running.delete(name);
  }

  /** Moves everything to where it is now; whether something goes on moving. */
  step(): boolean {
    const now = performance.now();
    for (const [name, movement] of this.running) {
      const share = (now - movement.started) / movement.durationMs;
      movement.apply(share < 1 ? movement.at(Math.max(0, share)) : movement.target);
      if (!(share < 1)) this.stop(name);
    }
    return this.running.size > 0;
  }

  stopAll(): void {
    for (const name of [...this.running.keys()]) this.stop(name);
  }
}
