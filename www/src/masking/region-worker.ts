/** Finds regions outside of the main thread, so that the brush never waits. */
import type { View } from "./grid.js";
import { regionOf } from "./region.js";
import type { Stroke } from "./strokes.js";

/** The view comes with the first question. */
export interface RegionCall {
  view?: View;
  strokes: readonly Stroke[];
}

let view: View | null = null;

addEventListener("message", ({ data }: MessageEvent<RegionCall>) => {
  view = data.view ?? view;
  if (view !== null) postMessage(regionOf(view, data.strokes));
});
