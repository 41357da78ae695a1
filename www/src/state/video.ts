/** The video: frames with one object, and its tracked poses. */
import { signal } from "@preact/signals";
import type { DepthCalibration, Sim3, TrackedFrame } from "sim3align";
import type { Inputs } from "./inputs.js";
import type { ObjectWork } from "./object-work.js";

/** The pose of a frame. */
export interface FramePose {
  readonly transform: Sim3;
  /** Null for a pose that a person has set, or that was changed with it. */
  readonly confidence: number | null;
  readonly state: TrackedFrame["state"];
  /** Whether a person has set it. */
  readonly isCorrected: boolean;
  /** In whose depth the pose is, of frames whose depth is not fully known. */
  readonly calibration: DepthCalibration | null;
}

export interface Video {
  readonly frames: readonly Inputs[];
  /** The poses of the cameras of all frames, camera to world; null if one is unknown. */
  readonly cameras: readonly Sim3[] | null;
}

/** What is done in a video. */
export interface VideoWork {
  frameIndex: number;
  framePoses: readonly (FramePose | null)[];
  frameWorks: readonly (ObjectWork | null)[];
}

/** The state of a video. */
export function videoState() {
  const video = signal<Video | null>(null);

  /** The index of the frame that is shown. */
  const frameIndex = signal(0);

  /** The poses of the frames, as far as they were tracked. */
  const framePoses = signal<readonly (FramePose | null)[]>([]);

  /** What a person has done in the frames that were left: poses that are not the tracked ones, decisions and comments. */
  const frameWorks = signal<readonly (ObjectWork | null)[]>([]);

  return { video, frameIndex, framePoses, frameWorks };
}

export type VideoState = ReturnType<typeof videoState>;
