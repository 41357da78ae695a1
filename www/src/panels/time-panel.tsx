/** The time axis of a video. */
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import {
  acceptTracked,
  alignFrames,
  correctFrame,
  isTracking,
  lastAccepted,
  showFrame,
  stopTracking,
  trackAll,
} from "../alignment/video.js";
import { page } from "../state/page.js";
import type { FramePose } from "../state/video.js";
import { percent } from "../ui/texts.js";

const { frameIndex, framePoses, gizmo, selected, video } = page;

/** Time between frames while they are played. */
const FRAME_MS = 120;

const stateColours = {
  tracking: "light-dark(#2e9e5b, #4cc27d)",
  uncertain: "light-dark(#d99a1c, #f0bf66)",
  lost: "light-dark(#c9303b, #ff8080)",
  corrected: "var(--accent)",
};

const stateTitles = { tracking: "tracked", uncertain: "uncertain", lost: "lost" };

function titleOf(pose: FramePose | null): string {
  if (pose === null) return "not tracked";
  const title = pose.isCorrected ? "corrected" : stateTitles[pose.state];
  return pose.confidence === null ? title : `${title}, ${percent(pose.confidence)}`;
}

export function TimePanel() {
  const opened = video.value;
  useEffect(() => {
    addEventListener("keydown", onKey);
    return () => removeEventListener("keydown", onKey);
  }, []);
  if (opened === null) return null;
  const count = opened.frames.length;
  const index = frameIndex.value;
  const poses = framePoses.value;
  const trackedCount = poses.filter((pose) => pose !== null).length;
  const source = selected.value?.pose.value.source;
  const canCorrect = !isTracking.value && poses[index] != null && source !== "tracked" && source !== "start";
  return (
    <section class="row panel time" style={{ gridArea: "time" }} aria-label="Frames">
      <button
        type="button"
        id="previous-frame"
        aria-label="Previous frame"
        disabled={index === 0}
        onClick={() => showFrame(index - 1)}
      >
        ‹
      </button>
      <Play count={count} />
      <button
        type="button"
        id="next-frame"
        aria-label="Next frame"
        disabled={index + 1 >= count}
        onClick={() => showFrame(index + 1)}
      >
        ›
      </button>
      <div class="axis">
        <input
          id="frame"
          type="range"
          min="0"
          max={count - 1}
          value={index}
          aria-label="Frame"
          aria-valuetext={`${index + 1} of ${count}, ${titleOf(poses[index] ?? null)}`}
          onInput={({ currentTarget }) => showFrame(currentTarget.valueAsNumber)}
        />
        <div class="strip" aria-hidden="true">
          {poses.map((pose, i) => {
            const state = pose?.isCorrected ? "corrected" : pose?.state;
            const background = state && stateColours[state];
            return <span key={opened.frames[i]?.name} data-state={state ?? "none"} style={{ background }} />;
          })}
        </div>
      </div>
      <span class="frame-name" id="frame-name">
        {index + 1}/{count} · {titleOf(poses[index] ?? null)}
      </span>
      {isTracking.value ? (
        <button type="button" id="stop-tracking" onClick={stopTracking}>
          Stop
        </button>
      ) : (
        <button type="button" id="track" class={trackedCount < count ? "primary" : ""} onClick={trackAll}>
          {trackedCount === 0 ? "Track" : "Track again"}
        </button>
      )}
      {opened.cameras !== null && (
        <button
          type="button"
          id="align-frames"
          disabled={isTracking.value}
          title="The object has not moved: all views of the known cameras together give one pose"
          onClick={alignFrames}
        >
          Align as views
        </button>
      )}
      <button type="button" id="correct" disabled={!canCorrect} onClick={correctFrame}>
        Use this pose
      </button>
      <button type="button" id="accept-tracked" disabled={isTracking.value} onClick={acceptTracked}>
        {lastAccepted.value.length > 0 ? `Take ${lastAccepted.value.length} back` : "Accept all tracked"}
      </button>
    </section>
  );
}

function Play({ count }: { count: number }) {
  useEffect(() => stopPlaying, []);
  return (
    <button
      type="button"
      id="play"
      aria-label={isPlaying.value ? "Pause" : "Play"}
      disabled={isTracking.value}
      onClick={() => (isPlaying.peek() ? stopPlaying() : play(count))}
    >
      {isPlaying.value ? "⏸" : "▶"}
    </button>
  );
}

/** Space plays, and arrows go from frame to frame, unless a control or the handles have a use for these keys. */
function onKey(event: KeyboardEvent): void {
  const { key, target } = event;
  const opened = video.peek();
  if (
    opened === null ||
    target !== document.body ||
    event.defaultPrevented ||
    gizmo.peek() !== null ||
    isTracking.peek()
  )
    return;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const step = { ArrowLeft: -1, ArrowRight: 1 }[key];
  if (step !== undefined) showFrame(frameIndex.peek() + step);
  else if (key === " ") isPlaying.peek() ? stopPlaying() : play(opened.frames.length);
  else return;
  event.preventDefault();
}

let timer: ReturnType<typeof setTimeout> | undefined;

const isPlaying = signal(false);

function stopPlaying(): void {
  clearTimeout(timer);
  isPlaying.value = false;
}

/** Shows the frames one after the other; from the last one, from the beginning. */
async function play(count: number): Promise<void> {
  isPlaying.value = true;
  const next = frameIndex.peek() + 1 < count ? frameIndex.peek() + 1 : 0;
  await showFrame(next);
  // Another frame may have been chosen meanwhile.
  if (isPlaying.peek() && frameIndex.peek() === next && next + 1 < count)
    timer = setTimeout(() => play(count), FRAME_MS);
  else stopPlaying();
}
