/// <reference lib="esnext.disposable" preserve="true" />
/** Trackers: one object through a video. */

import type { Job, Method } from "../calls/calls.js";
import { type Engine, type MainThreadEngine, signalsOf } from "../calls/engine.js";
import { ProgressListener } from "../calls/progress.js";
import { checkSignals, onAbort } from "../concurrency/on-abort.js";
import type { CorrectedFrame } from "../generated/types.js";
import { coreSim3, type Sim3Like } from "../input/sim3.js";
import type { FrameInput, MeshInput } from "../types/inputs.js";
import type { CallOptions } from "../types/options.js";
import type { SignalLike } from "../types/platform.js";
import type { TrackedFrame } from "../types/results.js";
import { plainArgument } from "../values/border.js";
import { disposed, internalError, invalidArgument, Sim3AlignError, withStackOf } from "../values/error.js";
import { sendableParts } from "../values/transfer.js";
import { checkedFlag, checkedOptions, checkedSignal } from "./aligner-options.js";

/**
 * The engine of a tracker. One that other calls share outlives the tracker.
 * @internal
 */
export type OwnEngine = { engine: MainThreadEngine; isShared: true } | { engine: Engine; isShared: false };

/**
 * The mesh of a tracker, and its id if it is prepared.
 * @internal
 */
export interface TrackerMesh {
  data: { mesh: MeshInput };
  meshId?: number;
}

let lastTracker = 0;

/**
 * Follows one object through the frames of a video. Each pose starts at that of the frame before; the size sharpens over
 * the frames that show the object from other sides, and then stays. Calls run in their order; the same frames give
 * bit-identical results with and without workers.
 * @example
 * ```ts
 * const tracker = await aligner.track(mesh);
 * const first = await tracker.next({ depth, mask, camera });
 * const second = await tracker.next({ depth: nextDepth, camera });
 * tracker.dispose();
 * ```
 */
export class Tracker {
  readonly #id: number;
  readonly #own: OwnEngine;
  readonly #onDispose: (tracker: Tracker) => void;
  #last: Promise<unknown> = Promise.resolve();
  /** Ends the call that runs, between two of its steps, when the tracker is disposed. */
  readonly #progress = new ProgressListener(undefined);
  /** Ends the connection to the signal. */
  #unfollow = () => {};

  private constructor(id: number, own: OwnEngine, onDispose: (tracker: Tracker) => void) {
    this.#id = id;
    this.#own = own;
    this.#onDispose = onDispose;
  }

  /** @internal */
  static async open(
    own: OwnEngine,
    mesh: TrackerMesh,
    options: object,
    signal: SignalLike | undefined,
    onDispose: (tracker: Tracker) => void,
  ): Promise<Tracker> {
    lastTracker += 1;
    const tracker = new Tracker(lastTracker, own, onDispose);
    try {
      if (signal !== undefined) {
        checkSignals([signal]);
        tracker.#unfollow = onAbort(signal, () => tracker.dispose());
      }
      await tracker.#inOrder({
        method: "openTracker",
        ...mesh,
        options: { tracker: tracker.#id, settings: options },
      });
      if (signal !== undefined) checkSignals([signal]);
      return tracker;
    } catch (error) {
      tracker.dispose();
      // An abort ends the tracker, which rejects the call with DISPOSED.
      if (signal !== undefined) checkSignals([signal]);
      throw error;
    }
  }

  /**
   * The pose in the next frame.
   *
   * A frame without a mask is looked at where the object should be. While the object is lost (`state`), it is searched for
   * in frames with a mask. The first frame needs a mask, unless `initial` is given.
   * @param options `signal` rejects a call that has not begun; a frame that has begun is tracked to its end
   * @throws {@link Sim3AlignError} for invalid input, `NO_CONSENSUS` if the object is not found in the first frame, and
   * `DISPOSED` after `dispose()`; the tracker remains usable. `TRACKER_LOST` if its worker has ended, or if another call has
   * exhausted the memory that they share: open another tracker with the last pose as `initial`
   */
  async next(frame: FrameInput, options: CallOptions = {}): Promise<TrackedFrame> {
    const { signal, transfer = false } = checkedOptions(options);
    const listened = checkedSignal(signal);
    const isMoved = checkedFlag("transfer", transfer);
    const data = plainArgument("input", frame);
    const job = { method: "trackFrame", data, options: { tracker: this.#id } } as const;
    const { result, data: moved } = await this.#inOrder(job, isMoved, listened);
    return isMoved ? { ...result, input: moved } : result;
  }

  /**
   * Sets the pose of a frame, for example that of an annotator, and carries it on: forwards to the next frames, and
   * backwards to all frames since the object was last found anew, with the motion that was tracked.
   * @param pose camera from mesh, metres
   * @param frame the number of the frame (`frame` of its result); by default the last one
   * @returns the new poses of all frames that change
   * @throws {@link Sim3AlignError} `INVALID_TRANSFORM`, `INVALID_ARGUMENT` for a frame that was not tracked, or that
   * is not among the last 100 000, and `TRACKER_LOST` if the worker of the tracker has ended
   */
  async correct(pose: Sim3Like, frame?: number): Promise<CorrectedFrame[]> {
    // Any other value could not be sent to the worker in which the tracker lives.
    if (frame !== undefined && frame !== null && typeof frame !== "number") {
      throw invalidArgument("frame", frame, "the number of a frame", "Pass `frame` of its result.");
    }
    const data = { pose: sendableParts(coreSim3(plainArgument("pose", pose))), frame };
    return (await this.#inOrder({ method: "correctTrack", data, options: { tracker: this.#id } })).result;
  }

  /** Ends the tracker, and frees its worker. Running and later calls reject with `DISPOSED`. */
  dispose(): void {
    if (this.#progress.failed.aborted) return;
    this.#progress.end(disposed());
    this.#unfollow();
    this.#onDispose(this);
    const own = this.#own;
    // The call that runs, which may be the opening, ends first.
    if (own.isShared) this.#last.then(() => own.engine.closeTracker(this.#id)).catch(() => {});
    else own.engine.dispose();
  }

  /** Ends the tracker at the end of the scope of a `using` declaration. */
  [Symbol.dispose](): void {
    this.dispose();
  }

  /** Runs a job after those before. One that has not begun when the signal aborts is left out. */
  #inOrder<M extends Method>(job: Job<M>, transfer = false, signal?: SignalLike) {
    const begin = new Error();
    const own = this.#last
      .then(() => this.#run(job, transfer, signal))
      .catch((error) => {
        throw error instanceof Sim3AlignError ? withStackOf(error, begin) : error;
      });
    this.#last = own.catch(() => {});
    return own;
  }

  async #run<M extends Method>(job: Job<M>, transfer: boolean, signal: SignalLike | undefined) {
    if (signal !== undefined) checkSignals([signal]);
    const call = { signal: undefined, progress: this.#progress, transfer };
    checkSignals(signalsOf(call));
    try {
      const outcome = await this.#own.engine.run(job, call);
      checkSignals(signalsOf(call));
      return outcome;
    } catch (error) {
      throw error instanceof Sim3AlignError ? error : internalError(error);
    }
  }
}
