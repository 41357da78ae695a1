/** Intrinsics for an image: scaled from the size that they belong to, or with a doubt where nothing states that size. */
import { failure } from "../values/error.js";
import type { ImageSize } from "../values/pixels.js";
import { type Pinhole, resizedPinhole } from "./pinhole.js";

/** The intrinsics of an image. */
export interface ImageCamera {
  camera: Pinhole;
  /** Reasons why the intrinsics may be those of another image. */
  doubts: readonly string[];
}

/** Largest principal point and focal length of intrinsics in image sizes; those in pixels are larger. */
const MAX_NORMALISED = { center: 2, focal: 20 } as const;

/** Distance of a principal point from the centre, in image sizes, from which it is that of a crop or of another image. */
const OFF_CENTRE = 0.15;

/** Difference of the coordinates of a principal point, in image sizes and relative to the focal lengths, that one scale explains. */
const ON_DIAGONAL = 0.02;

/** Distances of principal points from the centre, in image sizes: of an image that is turned, and of one that is upright. */
const TURNED = { most: 0.06, otherwise: 0.1 } as const;

/** Depth models compute at multiples of patches, which changes the shape of an image by up to half a patch on each side. */
const PATCH_PX = 14;
const LARGE_PATCHES_PX = [16, 32] as const;

/**
 * The intrinsics of an image of size `image`.
 * @param stated those in pixels, or in sizes, of an image of size `own`, if that is known
 * @throws {@link Sim3AlignError} `SIZE_MISMATCH` for sizes of other shapes: one of the images is cropped
 */
export function imageCamera(
  argument: string,
  stated: Pinhole,
  own: ImageSize | undefined,
  image: ImageSize,
): ImageCamera {
  const camera = inPixels(stated, own ?? image);
  const fitted = own === undefined ? unsizedCamera(camera, image) : scaledCamera(argument, camera, own, image);
  return { ...fitted, doubts: [...doubtOfSides(stated, own ?? image), ...fitted.doubts] };
}

/** Intrinsics of an image whose size is not stated beside them. */
function unsizedCamera(camera: Pinhole, image: ImageSize): ImageCamera {
  if (isTurned(camera, image)) return turnedCamera(camera, image);
  const doubt = doubtOfSize(camera, image);
  return { camera, doubts: doubt === undefined ? [] : [doubt] };
}

const isNormalised = ({ fx, fy, cx, cy }: Pinhole) =>
  Math.max(cx, cy) < MAX_NORMALISED.center && Math.max(fx, fy) < MAX_NORMALISED.focal;

/** Intrinsics in pixels. Those in image sizes, as MoGe writes them, count from the outer edge of the first pixel. */
export function inPixels({ fx, fy, cx, cy }: Pinhole, size: ImageSize | undefined): Pinhole {
  if (!isNormalised({ fx, fy, cx, cy }) || size === undefined) return { fx, fy, cx, cy };
  const [x, y] = sidesOf({ fx, fy, cx, cy }, size);
  return { fx: fx * x, fy: fy * y, cx: cx * x - 0.5, cy: cy * y - 0.5 };
}

/** Difference of focal lengths, as a logarithm, up to which pixels are about square. */
const SQUARE = 0.05;

/** Whether the focal lengths suggest that both axes are relative to the same side: relative to their own, pixels would not be square. */
const isOfOneSide = ({ fx, fy }: Pinhole, { width, height }: ImageSize) =>
  Math.abs(Math.log(fx / fy)) < SQUARE && Math.abs(Math.log(width / height)) > SQUARE;

/** The side that each axis is relative to: its own or, where that centres the principal point better, the same for both. */
function sidesOf(camera: Pinhole, size: ImageSize): readonly [number, number] {
  const { width, height } = size;
  const own = [width, height] as const;
  if (!isOfOneSide(camera, size)) return own;
  const distance = ([x, y]: readonly [number, number]) =>
    Math.max(Math.abs((camera.cx * x) / width - 0.5), Math.abs((camera.cy * y) / height - 0.5));
  const others = [[width, width] as const, [height, height] as const];
  return others.reduce((best, sides) => (distance(sides) < distance(best) ? sides : best), own);
}

/** Why normalised intrinsics may be relative to other sides. */
function doubtOfSides(stated: Pinhole, size: ImageSize): string[] {
  if (!isNormalised(stated) || !isOfOneSide(stated, size)) return [];
  const [x, y] = sidesOf(stated, size);
  const read = x === y ? `both were read as parts of ${x} pixels` : "the pixels would not be square";
  return [
    `The focal lengths, in sizes of an image of ${size.width} × ${size.height} pixels, are about equal: ${read}. Write the intrinsics in pixels.`,
  ];
}

/** Intrinsics for an image that is `image` instead of `own` pixels large. */
function scaledCamera(argument: string, camera: Pinhole, own: ImageSize, image: ImageSize): ImageCamera {
  if (isOfShape(own, image)) return { camera: resizedPinhole(camera, own, image), doubts: [] };
  const upright = { width: own.height, height: own.width };
  if (isOfShape(upright, image)) {
    const landscape = { width: image.height, height: image.width };
    return turnedCamera(resizedPinhole(camera, own, landscape), image);
  }
  throw failure(
    "SIZE_MISMATCH",
    argument,
    `intrinsics for ${own.width} × ${own.height} pixels, but an image of ${image.width} × ${image.height}`,
    "intrinsics of the same image, or of one of the same shape",
    "Subtract from cx and cy where the crop begins, and leave out width and height.",
  );
}

/** Whether an image may be another one at another size. */
function isOfShape(own: ImageSize, image: ImageSize): boolean {
  const [x, y] = [image.width / own.width, image.height / own.height];
  // Sides are rounded to whole pixels.
  const rounding = 1 / Math.min(own.width, own.height, image.width, image.height);
  if (Math.abs(Math.log(x / y)) <= 2 * rounding) return true;
  const scale = Math.sqrt(x * y);
  const isOf = (patch: number) =>
    [image.width, image.height].every((side) => side % patch === 0) &&
    [image.width - scale * own.width, image.height - scale * own.height].every(
      (off) => Math.abs(off) <= 0.5 * patch + 1,
    );
  // A crop may have sides of whole large patches as well, but it keeps the scale.
  return isOf(PATCH_PX) || (Math.abs(Math.log(scale)) > 0.1 && LARGE_PATCHES_PX.some(isOf));
}

/** A principal point in image sizes. */
const placeOf = ({ cx, cy }: Pinhole, { width, height }: ImageSize) =>
  [(cx + 0.5) / width, (cy + 0.5) / height] as const;

const offCentre = (place: readonly number[]) => Math.max(...place.map((x) => Math.abs(x - 0.5)));

/** Whether the principal point fits the image only after a quarter turn. */
function isTurned(camera: Pinhole, { width, height }: ImageSize): boolean {
  const turned = placeOf(camera, { width: height, height: width });
  return offCentre(placeOf(camera, { width, height })) > TURNED.otherwise && offCentre(turned) < TURNED.most;
}

/** The intrinsics after a quarter turn clockwise, from landscape to upright on most phones. */
function turnedCamera({ fx, fy, cx, cy }: Pinhole, { width, height }: ImageSize): ImageCamera {
  const camera = { fx: fy, fy: fx, cx: width - 1 - cy, cy: cx };
  // The other direction differs by twice the distance from the centre.
  const difference = Math.round(2 * Math.hypot(camera.cx - 0.5 * (width - 1), camera.cy - 0.5 * (height - 1)));
  const doubt = `The principal point (${Math.round(cx)}, ${Math.round(cy)}) fits an image turned by 90°, of ${height} × ${width} pixels: x and y were swapped (clockwise; to the other side, it differs by ${difference} pixels). Pass those of the image as it is.`;
  return { camera, doubts: [doubt] };
}

/**
 * Why intrinsics may be those of an image of another size: the principal point is outside the image, or on the diagonal and
 * off the centre. That of a crop may be outside, too. `undefined` without such a doubt.
 */
export function doubtOfSize(camera: Pinhole, { width, height }: ImageSize): string | undefined {
  const { fx, fy, cx, cy } = camera;
  const [x, y] = placeOf(camera, { width, height });
  const isOutside = [x, y].some((place) => place < 0 || place > 1);
  // Another ratio of the sides stretches the focal lengths as well.
  const isScaled = Math.abs(x - (y * fx) / fy) < ON_DIAGONAL && offCentre([x, y]) > OFF_CENTRE;
  if (!isOutside && !isScaled) return undefined;
  const place = isOutside
    ? "outside the image"
    : `${Math.round(100 * x)} % of the way across and ${Math.round(100 * y)} % down the image`;
  return `The principal point (${Math.round(cx)}, ${Math.round(cy)}) is ${place} of ${width} × ${height} pixels: the intrinsics seem to be those of an image of another size. State its width and height beside them; for a crop, those of the crop.`;
}
