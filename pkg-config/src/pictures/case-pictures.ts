/** The pictures of a case: its observation, the pose over it, and the pose from another side. */
import { ground, outlines, over, shaded, translucent } from "./layers.js";
import { pngOf } from "./png.js";
import type { Shot } from "./shot.js";
import { threeQuarterView } from "./three-quarter-view.js";
import { type Box, boxOf, unionOf, View } from "./view.js";

/** Size of the pictures of a report, pixels. */
const PICTURE = { width: 240, height: 180 };
/** Pixels per pixel of the depth map of the image in which the mesh is looked for. */
const COARSE = 0.25;
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
  const whole = { left: 0, top: 0, width, height };
  const shown = unionOf([boxOf(mask, width, height), await boxOfMesh(shot, pose)], whole);
  const view = View.around(shown, PICTURE.width, PICTURE.height, MARGIN);
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

/** The box of the drawn mesh, in pixels of the depth map, to a few pixels. */
async function boxOfMesh(shot: Shot, pose: Matrix): Promise<Box | undefined> {
  const view = View.whole(shot.width, shot.height, COARSE);
  const box = boxOf(await shot.render(view, pose), view.width, view.height);
  if (box === undefined) return undefined;
  return {
    left: box.left / COARSE,
    top: box.top / COARSE,
    width: box.width / COARSE,
    height: box.height / COARSE,
  };
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
