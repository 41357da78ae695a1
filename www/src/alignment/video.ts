/** Shows and tracks the frames of a video. */
import { batch, computed, signal } from "@preact/signals";
import type { Tracker, ViewInput } from "sim3align";
import { toSim3 } from "sim3align/conventions/similarity";
import { readInputs, sceneOf } from "../input/reading.js";
import { videoOf } from "../input/video-frames.js";
import { inCalibration } from "../state/calibration.js";
import type { Inputs } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import { applyToObject, type ObjectWork, stateOf } from "../state/object-work.js";
import { page } from "../state/page.js";
import type { Scene } from "../state/scene.js";
import type { FramePose, Video, VideoWork } from "../state/video.js";
import { aligner, givenViewOf } from "./aligner.js";

const {
  announce,
  constraintsOf,
  frameIndex,
  framePoses,
  frameWorks,
  inputs,
  recalibrate,
  scene,
  sceneOptions,
  show,
  video,
} = page;

const controller = signal<AbortController | null>(null);
export const isTracking = computed(() => controller.value !== null);

/** The tracker of the last run, which corrections need. */
let tracker: Tracker | null = null;

/** Tracking of a video that was left: it goes on where it was once the video is opened again. */
interface Paused {
  id: string;
  tracker: Tracker;
  next: number;
  /** The pose of the last frame, which came after the video was left. */
  late: FramePose | null;
}

let paused: Paused | null = null;

/** Opens a video, as it was left. Returns false if the frame cannot be read. */
export async function openVideo({ frames = [] }: Inputs, done: VideoWork = begun): Promise<boolean> {
  const { frameIndex: index } = done;
  const frame = frames[index];
  const read = frame && (await readFrame(frame));
  if (frame === undefined || read == null) return false;
  const opened = await videoOf(frames);
  const ofFrames = <T>(of: readonly (T | null)[]) => opened.frames.map((_, i) => of[i] ?? null);
  // At once: without its frames, the video before would be stored as if nothing had been done in it.
  batch(() => {
    closeVideo();
    video.value = opened;
    framePoses.value = ofFrames(done.framePoses);
    frameWorks.value = ofFrames(done.frameWorks);
    put(index, frame, read);
  });
  if (paused?.id === frame.id) trackAll();
  return true;
}

const begun: VideoWork = { frameIndex: 0, framePoses: [], frameWorks: [] };

/** What is done in the video, with what is done in the frame that is shown. */
export const videoWork = (): VideoWork => ({
  frameIndex: frameIndex.value,
  framePoses: framePoses.value,
  frameWorks: frameWorks.value.map((work, i) => (i === frameIndex.value ? workOf(scene.value?.objects[0]) : work)),
});

/** What a person has done with the object of a frame; null for a pose as it was tracked. */
function workOf(object: ObjectModel | undefined): ObjectWork | null {
  if (object === undefined) return null;
  const { comment, pose, verdict } = object;
  const isUntouched =
    ["start", "tracked"].includes(pose.value.source) && verdict.value === null && comment.value === "";
  return isUntouched ? null : stateOf(object);
}

/** Whether a decision holds the pose of a frame. */
const isHeld = (index: number) => frameWorks.peek()[index]?.verdict != null;

/** Forgets the video, for another scene. What is being tracked pauses by itself. */
function closeVideo(): void {
  if (!isTracking.peek()) tracker?.dispose();
  tracker = null;
  video.value = null;
  framePoses.value = [];
  frameWorks.value = [];
}

export function stopTracking(): void {
  controller.peek()?.abort();
}

/** The number of the last call of `showFrame`. The results of earlier ones are discarded. */
let lastCall = 0;

/** Shows a frame with its pose. */
export async function showFrame(index: number): Promise<void> {
  const frame = video.peek()?.frames[index];
  if (frame === undefined || index === frameIndex.peek()) return;
  const call = ++lastCall;
  const opened = await readFrame(frame);
  // Another scene may have been opened meanwhile.
  if (call === lastCall && opened !== null && video.peek()?.frames[index] === frame) put(index, frame, opened);
}

async function readFrame(frame: Inputs, begun = readInputs(frame)): Promise<Scene | null> {
  const reading = await begun;
  const opened = sceneOf(frame, reading, true);
  if (opened === null) {
    announce(`${frame.name}: ${reading.problems[0]?.message ?? "a part is missing"}`, "failed");
  }
  return opened;
}

function put(index: number, frame: Inputs, opened: Scene): void {
  const [object] = opened.objects;
  // Of another scene or video, nothing is carried on.
  const before = inputs.peek().id === frame.id ? scene.peek()?.objects[0] : undefined;
  if (object !== undefined && before !== undefined) object.knownScale.value = before.knownScale.peek();
  batch(() => {
    if (before !== undefined && index !== frameIndex.peek()) frameWorks.value = videoWork().frameWorks;
    const [pose, work] = [framePoses.peek()[index], frameWorks.peek()[index]];
    frameIndex.value = index;
    show(opened, frame, false);
    if (object === undefined) return;
    if (pose != null) showPose(object, pose);
    if (work != null) applyToObject(work, object);
  });
}

/** Shows the pose of the frame that is shown, in its depth. */
function showPose(object: ObjectModel, { calibration, transform }: FramePose): void {
  const whole = scene.peek();
  if (calibration !== null && whole !== null) recalibrate(inCalibration(whole, calibration));
  object.pose.value = { transform, source: "tracked" };
}

/** Runs work on the frames, unless other work is running; it can be stopped. */
async function run(work: (opened: Video, first: ObjectModel, signal: AbortSignal) => Promise<void>): Promise<void> {
  const [opened, first] = [video.peek(), scene.peek()?.objects[0]];
  if (opened === null || first === undefined || isTracking.peek()) return;
  const abort = new AbortController();
  controller.value = abort;
  frameWorks.value = videoWork().frameWorks;
  try {
    await work(opened, first, abort.signal);
  } catch (error) {
    if (abort.signal.aborted) announce("Stopped.");
    else fail(error);
  } finally {
    controller.value = null;
  }
}

/** What is known of the scale. */
function scaleOf(object: ObjectModel) {
  const { scale } = constraintsOf(object);
  return scale === undefined ? {} : { scale };
}

/** The mask of a frame, if it has one. */
const maskOf = (frame: Inputs, object: ObjectModel) => (frame.objects[0]?.mask == null ? {} : { mask: object.mask });

/** Tracks the object through all frames, and shows them as they come. */
export const trackAll = () =>
  run(async (opened, first, signal) => {
    const started = performance.now();
    const [{ id }, count] = [inputs.peek(), opened.frames.length];
    const from = paused?.id === id ? paused : null;
    if (from === null) paused?.tracker.dispose();
    paused = null;
    tracker?.dispose();
    // A pose that a person has set in the first frame is where tracking begins.
    const { source, transform } = first.pose.peek();
    const initial = frameIndex.peek() === 0 && source === "hand" ? transform : null;
    const settings = { ...sceneOptions(), initial, ...scaleOf(first) };
    const own = from?.tracker ?? (await (await aligner()).track(first.mesh, settings));
    let late = from?.late ?? null;
    // The next frame is decoded on this thread while the worker tracks in the one before it.
    let following: ReturnType<typeof readInputs> | undefined;
    for (let index = from?.next ?? 0; ; index++) {
      if (!isShown(id)) {
        paused = { id, tracker: own, next: index, late };
        const name = page.list.peek().find((one) => one.inputs.id === id)?.inputs.name ?? "the video";
        return announce(`Tracking of ${name} waits after frame ${index} of ${count}: open it to go on.`);
      }
      tracker = own;
      if (late !== null) setPose(index - 1, late);
      late = null;
      const frame = video.peek()?.frames[index];
      if (frame === undefined) break;
      if (signal.aborted) return announce("Stopped.");
      announce(`Tracking frame ${index + 1} of ${count} …`, "working");
      const read = await readFrame(frame, following);
      const object = read?.objects[0];
      if (read === null || object === undefined) return;
      const { image: _, ...view } = givenViewOf(read);
      const tracked = own.next({ ...view, ...maskOf(frame, object) });
      const next = opened.frames[index + 1];
      following = next && readInputs(next);
      const { confidence, depthCalibration: calibration = null, state, ...found } = await tracked;
      const pose: FramePose = { transform: toSim3(found), confidence, state, isCorrected: false, calibration };
      if (!isShown(id)) late = pose;
      else {
        setPose(index, pose);
        put(index, video.peek()?.frames[index] ?? frame, read);
      }
    }
    const lost = framePoses.peek().filter((pose) => pose?.state === "lost").length;
    const seconds = ((performance.now() - started) / 1000).toFixed(1);
    announce(`Tracked ${count} frames in ${seconds} s${lost > 0 ? `; lost in ${lost}` : ""}.`);
  });

/** Whether the video with this id is shown. */
const isShown = (id: string) => video.peek() !== null && inputs.peek().id === id;

/** Sets the tracked pose of a frame, unless a decision holds the one that it has. */
function setPose(index: number, pose: FramePose): void {
  if (isHeld(index)) return;
  framePoses.value = framePoses.peek().map((other, i) => (i === index ? pose : other));
  frameWorks.value = frameWorks.peek().map((other, i) => (i === index ? null : other));
}

/** Aligns the object in all frames together, as views of cameras whose poses are known: it has not moved. */
export const alignFrames = () =>
  run(async (opened, first, signal) => {
    const { id } = inputs.peek();
    const views: ViewInput[] = [];
    for (const [index, frame] of opened.frames.entries()) {
      announce(`Reading view ${index + 1} of ${opened.frames.length} …`, "working");
      const read = await readFrame(frame);
      const object = read?.objects[0];
      const cameraToWorld = opened.cameras?.[index];
      if (read === null || object === undefined || cameraToWorld === undefined) return;
      views.push({ ...givenViewOf(read), ...maskOf(frame, object), cameraToWorld });
    }
    announce(`Aligning ${views.length} views together …`, "working");
    const settings = { ...sceneOptions(), ...scaleOf(first), signal };
    const found = await (await aligner()).alignViews({ mesh: first.mesh, views }, settings);
    if (!isShown(id)) return;
    framePoses.value = found.views.map((view, i): FramePose | null => {
      if (isHeld(i)) return framePoses.peek()[i] ?? null;
      const { confidence, depthCalibration: calibration = null } = view;
      const state = confidence >= 0.5 ? "tracking" : "uncertain";
      return { transform: toSim3(view), confidence, state, isCorrected: false, calibration };
    });
    frameWorks.value = frameWorks.peek().map((work, i) => (isHeld(i) ? work : null));
    const [shown, pose] = [scene.peek()?.objects[0], framePoses.peek()[frameIndex.peek()]];
    if (shown !== undefined && pose != null && !isHeld(frameIndex.peek())) showPose(shown, pose);
    announce(`Aligned ${views.length} views together, ${Math.round(100 * found.confidence)} %.`);
  });

/** Takes the pose that is shown as the right one, and carries the difference to the frames before and after. */
export async function correctFrame(): Promise<void> {
  const object = scene.peek()?.objects[0];
  const index = frameIndex.peek();
  if (object === undefined || framePoses.peek()[index] == null) return;
  const { transform } = object.pose.peek();
  try {
    // The tracker of a video that was restored is gone.
    const changed = (await tracker?.correct(transform, index)) ?? [{ ...transform, frame: index }];
    const poses: (FramePose | null)[] = [...framePoses.peek()];
    for (const found of changed) {
      const before = poses[found.frame];
      const isOwn = found.frame === index;
      if (before == null || (isHeld(found.frame) && !isOwn)) continue;
      poses[found.frame] = {
        ...before,
        transform: toSim3(found),
        // What the tracker said of the pose before says nothing of this one.
        confidence: null,
        state: isOwn ? "tracking" : before.state,
        isCorrected: isOwn || before.isCorrected,
      };
    }
    framePoses.value = poses;
    object.rebase({ transform, source: "tracked" });
    announce(
      tracker === null
        ? "Corrected this frame. Track again to carry it to the others."
        : `Corrected ${changed.length} frames.`,
    );
  } catch (error) {
    fail(error);
  }
}

/** The frames that were accepted together last, which can be taken back together. */
export const lastAccepted = signal<readonly number[]>([]);

/** Accepts all frames that were tracked without a doubt and are open or, just after that, takes it back. */
export function acceptTracked(): void {
  const taken = lastAccepted.peek();
  const works = videoWork().frameWorks;
  const isTracked = (pose: FramePose | null, i: number) => pose?.state === "tracking" && works[i]?.verdict == null;
  const chosen = taken.length > 0 ? taken : framePoses.peek().flatMap((pose, i) => (isTracked(pose, i) ? [i] : []));
  const verdict = taken.length > 0 ? null : "accepted";
  frameWorks.value = works.map((work, i) => (chosen.includes(i) ? { ...(work ?? asTracked(i)), verdict } : work));
  const shown = scene.peek()?.objects[0];
  if (shown !== undefined && chosen.includes(frameIndex.peek()))
    shown.decision.value = verdict && { verdict, pose: shown.pose.peek() };
  lastAccepted.value = taken.length > 0 ? [] : chosen;
  announce(taken.length > 0 ? `${chosen.length} frames are open again.` : `Accepted ${chosen.length} frames.`);
}

/** The work of a frame of which only the tracked pose is known. */
const asTracked = (index: number): ObjectWork => ({
  matrix: [...(framePoses.peek()[index]?.transform.matrix ?? [])],
  ...{ source: "tracked", verdict: null, isShown: true, isLocked: false, knownScale: null, alignment: null },
});

const fail = (error: unknown) => announce(error instanceof Error ? error.message : `${error}`, "failed");

// Another scene ends the video.
inputs.subscribe(({ id }) => {
  const opened = video.peek();
  if (opened !== null && opened.frames[0]?.id !== id) closeVideo();
  lastAccepted.value = [];
});
