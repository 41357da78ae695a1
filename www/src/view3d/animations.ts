/** Animated changes of poses. */
import type { Vector3 } from "three/webgpu";
import { between, eased, matrixOf, poseOf } from "./pose.js";
import type { Animation, Matrix } from "./types.js";

interface Running {
  poseAt(share: number): Float64Array;
  started: number;
  durationMs: number;
  apply(pose: Matrix): void;
  target: Matrix;
  finish(): void;
}

/** The running animations, by name. A new one replaces that of the same name. */
export class Animations {
  private readonly running = new Map<string, Running>();

  /** Starts an animation. The promise resolves when it ends or is replaced. */
  start(
    name: string,
    { from, durationMs, delayMs = 0 }: Animation,
    target: Matrix,
    centre: Vector3,
    apply: (pose: Matrix) => void,
  ): Promise<void> {
    this.stop(name);
    const [first, last] = [poseOf(from), poseOf(target)];
    const poseAt = (share: number) => matrixOf(between(first, last, eased(share), centre));
    apply(from);
    return new Promise((finish) => {
      this.running.set(name, { poseAt, started: performance.now() + delayMs, durationMs, apply, target, finish });
    });
  }

  /** Stops an animation at its current pose. */
  stop(name: string): void {
    this.running.get(name)?.finish();
    this.running.delete(name);
  }

  /** Applies the current poses. Returns whether an animation is still running. */
  step(): boolean {
    const now = performance.now();
    for (const [name, animation] of this.running) {
      const share = (now - animation.started) / animation.durationMs;
      animation.apply(share < 1 ? animation.poseAt(Math.max(0, share)) : animation.target);
      if (!(share < 1)) this.stop(name);
    }
    return this.running.size > 0;
  }

  isRunning(name: string): boolean {
    return this.running.has(name);
  }

  stopAll(): void {
    for (const name of [...this.running.keys()]) this.stop(name);
  }
}
