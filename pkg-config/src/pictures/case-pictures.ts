/** The pictures of a case: its observation, and its poses over it. */
import { differenceLimit } from "./colours.js";
import { ground, maskTint, outlines, over, residual, shaded } from "./layers.js";
import { type Picture, pngOf } from "./png.js";
import type { Shot } from "./shot.js";
import { type SpaceJson, spaceOf } from "./space.js";
import { boxOf, View } from "./view.js";

/** Size of the pictures, pixels. */
const PICTURE = { width: 440, height: 330 };
const THUMBNAIL = { width: 160, height: 120 };
/** The surroundings that a picture shows, as a multiple of the object's box. */
const MARGIN = 1.5;
/** Longest side of an overlay of the whole image, pixels. */
const MAX_OVERLAY = 1600;

type Matrix = readonly number[];

/** Files of pictures, and their properties. */
export interface CasePictures {
  /** PNG files by name. */
  files: Record<string, Uint8Array>;
  /** The difference of depth whose colour is saturated, metres. */
  limitM: number;
  isPhoto: boolean;
  space: SpaceJson;
}

/** Draws the pictures of a case: the observation, and layers over it for the best pose and each alternative. */
export async function drawCase(shot: Shot, pose: Matrix, alternatives: readonly Matrix[]): Promise<CasePictures> {
  const { width, height, mask, depth } = shot;
  const whole = await shot.render(View.whole(width, height, 1), pose);
  const view = View.around(boxOf(mask, whole, width, height), PICTURE.width, PICTURE.height, MARGIN);
  const [seen, masked, mesh] = [ground(shot, view), view.sampled(mask, width, height), await shot.render(view, pose)];
  const measured = view.sampled(depth, width, height);
  const limitM = differenceLimit(visibleSize(mesh, shot, view));
  const pictures: Record<string, Picture> = {
    ground: seen,
    mask: maskTint(masked, view),
    outlines: outlines(masked, mesh, view),
    mesh: shaded(mesh, view, view.camera(shot.camera)),
    residual: residual({ mask: masked, measured, mesh }, view, limitM),
  };
  const zoom = (view.zoom * THUMBNAIL.width) / view.width;
  const small = new View(THUMBNAIL.width, THUMBNAIL.height, zoom, view.left, view.top);
  const smallGround = ground(shot, small);
  for (const [k, other] of alternatives.entries()) {
    const drawn = await shot.render(small, other);
    pictures[`alternative-${k + 1}`] = over(smallGround, shaded(drawn, small, small.camera(shot.camera)));
  }
  const thumbnail = await shot.render(small, pose);
  const smallMask = small.sampled(mask, width, height);
  pictures.thumbnail = over(smallGround, outlines(smallMask, thumbnail, small));
  const encoded = Object.entries(pictures).map(
    async ([name, picture]) => [`${name}.png`, await pngOf(picture)] as const,
  );
  return {
    files: Object.fromEntries(await Promise.all(encoded)),
    limitM,
    isPhoto: shot.photo !== undefined,
    space: spaceOf(shot, pose, { view, measured, picture: seen }),
  };
}

/** The whole image with the mask's outline and the shaded mesh, as a PNG. */
export async function drawOverlay(shot: Shot, pose: Matrix): Promise<Uint8Array> {
  const { width, height, photo, mask } = shot;
  // Photos are often larger than depth maps.
  const zoom = Math.min(Math.max(1, (photo?.width ?? 0) / width), MAX_OVERLAY / Math.max(width, height));
  const view = View.whole(width, height, zoom);
  const mesh = await shot.render(view, pose);
  const drawn = shaded(mesh, view, view.camera(shot.camera));
  // What is below stays visible.
  for (let i = 3; i < drawn.data.length; i += 4) drawn.data[i] = ((drawn.data[i] as number) * 0.45) | 0;
  return pngOf(over(ground(shot, view), drawn, outlines(view.sampled(mask, width, height), mesh, view)));
}

/** The size of the mesh across the view, metres. */
function visibleSize(mesh: Float32Array, shot: Shot, view: View): number {
  const { width, height } = view;
  const box = boxOf(mesh, mesh, width, height);
  const depths = mesh.filter((z) => z > 0).sort();
  const z = depths[depths.length >> 1] ?? 1;
  const { fx } = view.camera(shot.camera);
  return (Math.hypot(box.width, box.height) * z) / fx;
}
