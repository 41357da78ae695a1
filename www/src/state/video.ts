/** The video: frames with one object, and its tracked poses. */
import { signal } from "@preact/signals";
import type { TrackState } from "sim3align";
import type { Sim3 } from "sim3align/conventions";
import type { Inputs } from "../load/inputs.js";

/** The pose of a frame. */
export interface FramePose {
  readonly transform: Sim3;
  readonly confidence: number;
  readonly state: TrackState;
  /** Whether a person has set it. */
  readonly isCorrected: boolean;
}

export interface Video {
  readonly frames: readonly Inputs[];
  /** The poses of the cameras of all frames, camera to world; null if one is unknown. */
  readonly cameras: readonly Sim3[] | null;
}

/** The state of a video. */
export function videoState() {
  const video = signal<Video | null>(null);

  /** The index of the frame that is shown. */
  const frameIndex = signal(0);

  /** The poses of the frames, as far as they were tracked. */
  const framePoses = signal<readonly (FramePose | null)[]>([]);

  return { video, frameIndex, framePoses };
}
