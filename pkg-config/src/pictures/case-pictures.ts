/** The pictures of a case: its observation, the pose over it, and the pose from another side. */
import { ground, outlines, over, shaded, translucent } from "./layers.js";
import { pngOf } from "./png.js";
import type { Shot } from "./shot.js";
import { threeQuarterView } from "./three-quarter-view.js";
import { boxOf, View } from "./view.js";

/** Size of the pictures of a report, pixels. */
const PICTURE = { width: 280, height: 210 };
/** The surroundings that a picture shows, as a multiple of the object's box. */
const MARGIN = 1.5;
/** Longest side of an overlay of the whole image, pixels. */
const MAX_OVERLAY = 1600;

type Matrix = readonly number[];

/** The pictures of a case in a report, as PNG files by name, in the order in which they are shown. */
export const casePictures = {
  photo: "What was seen, around the object",
  overlay: "The mesh over it, with the outlines of mesh and mask",
  side: "Mesh and measured points from the side",
} as const;

/** Draws the pictures of a case. */
export async function drawCase(shot: Shot, pose: Matrix): Promise<Record<keyof typeof casePictures, Uint8Array>> {
  const { width, height, mask } = shot;
  const whole = await shot.render(View.whole(width, height, 1), pose);
  const view = View.around(boxOf(mask, whole, width, height), PICTURE.width, PICTURE.height, MARGIN);
  const seen = ground(shot, view);
  const mesh = await shot.render(view, pose);
  const outlined = outlines(view.sampled(mask, width, height), mesh, view);
  const drawn = translucent(shaded(mesh, view, view.camera(shot.camera)));
  const [photo, overlay, side] = await Promise.all([
    pngOf(seen),
    pngOf(over(seen, drawn, outlined)),
    threeQuarterView(shot, view, pose, seen).then(pngOf),
  ]);
  return { photo, overlay, side };
}

/** The whole image with the mask's outline and the shaded mesh, as a PNG. */
export async function drawOverlay(shot: Shot, pose: Matrix): Promise<Uint8Array> {
  const { width, height, photo, mask } = shot;
  // Photos are often larger than depth maps.
  const zoom = Math.min(Math.max(1, (photo?.width ?? 0) / width), MAX_OVERLAY / Math.max(width, height));
  const view = View.whole(width, height, zoom);
  const mesh = await shot.render(view, pose);
  const drawn = translucent(shaded(mesh, view, view.camera(shot.camera)));
  return pngOf(over(ground(shot, view), drawn, outlines(view.sampled(mask, width, height), mesh, view)));
}
