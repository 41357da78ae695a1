/** The video: frames with one object, and its tracked poses. */
import { computed, signal } from "@preact/signals";
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

  /** How many frames are tracked. */
  const trackedCount = computed(() => framePoses.value.filter((pose) => pose !== null).length);

  function setFramePose(index: number, pose: FramePose): void {
    framePoses.value = framePoses.peek().map((other, i) => (i === index ? pose : other));
  }

  return { video, frameIndex, framePoses, trackedCount, setFramePose };
}
