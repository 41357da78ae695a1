/** The focal length of a photo in pixels, from its EXIF data. */

import type { Exif } from "../types/files.js";
import type { ImageSize } from "../values/pixels.js";
import { finite, positive, record, withoutUndefined } from "../values/validation.js";

/** A focal length from EXIF data. */
export interface ExifFocal {
  /** In pixels of the image of the given size; the same along both sides. */
  focalPx: number;
  /** Relative standard deviation: 0.03 is 3 %. */
  uncertainty: number;
  /** What it was computed from, for people. */
  source: string;
}

/** A number, and the standard deviations of its logarithm from independent causes. */
interface Estimate {
  value: number;
  deviations: number[];
  source: string;
}

const FULL_FRAME_MM = [36, 24] as const;

/** Shortest equivalent focal length of lenses that draw straight lines; below are fisheyes. */
const MIN_EQUIVALENT_MM = 8;

/**
 * Tolerance of the focal length that is written on a lens or in its EXIF data. The real one may differ by 5 % (ISO 517),
 * and changes with the distance of focus.
 */
const LENS = 0.02;

/** The resolution of the focal plane, from which the width of the sensor is computed, is rounded. */
const SENSOR = 0.01;

/** Standard deviation of what is rounded to whole numbers. */
const ROUNDING = 1 / Math.sqrt(12);

/** Frames of cameras, 4:3 and 3:2. Others are cut from these, mostly without a word in the equivalent focal length. */
const FRAME_ASPECTS = [1.3, 1.55] as const;

/** Half of the difference of the diagonals of 16:9 and of the 4:3 from which it is cut. */
const CUT_FRAME = 0.04;

/** About one camera in five does not count the digital zoom in, as the standard asks. */
const ZOOM_FORGOTTEN = 0.2;

/** Largest difference of the two scales of an image that was resized as a whole, to sides that networks like. */
const MAX_STRETCH = 0.03;

/** About three crops in ten are resized as well. */
const CROP_RESIZED = 0.3;

/** An image that was edited may carry the EXIF data of a stage in between. */
const EDITED = 0.02;

/** Two sources that differ by more contradict each other. */
const MAX_DIFFERENCE = 0.1;

/**
 * The focal length of a photo that is `width` × `height` pixels when it is viewed, so after its EXIF orientation was applied.
 *
 * It is computed from the equivalent on full frame, which refers to the diagonal (43.27 mm), or from the focal length and
 * the width of the sensor, whichever is known better. If the image is smaller than its EXIF data state, in the same aspect,
 * it was resized, and the focal length with it. In another aspect, it was cropped: its focal length stays that of the
 * original, because a crop moves the edges of the image and not its pixels. That is certain if one side is still complete;
 * otherwise, the crop may have been resized as well, and the uncertainty grows with how much. If both sides are less than
 * half of the original, it surely was: then it is taken for a crop that was as large as possible.
 * @returns `undefined` if the data do not suffice, or are not those of this image
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for a size that is no positive number
 */
export function focalFromExif(exif: Exif, size: ImageSize): ExifFocal | undefined {
  const { make: _, model: __, ...given } = record("exif", exif, "the result of readExif");
  const numbers = Object.entries(withoutUndefined(given)).map(([name, value]) => [name, finite(`exif.${name}`, value)]);
  const { width, height } = record("size", size, "{ width, height }");
  const image = { width: positive("size.width", width), height: positive("size.height", height) };
  return focalFrom(Object.fromEntries(numbers), image);
}

/** {@link focalFromExif} without checks of the arguments. */
export function focalFrom(exif: Partial<Exif>, size: ImageSize): ExifFocal | undefined {
  const { width, height, orientation, ...camera } = exif;
  const image = [size.width, size.height] as const;
  const known = width !== undefined && height !== undefined && width > 0 && height > 0;
  const isTurned = (orientation ?? 1) >= 5;
  const original = known ? (isTurned ? ([height, width] as const) : ([width, height] as const)) : image;
  const scale = scaleOf(image, original);
  const focal = focalOf(camera, original, width);
  if (scale === undefined || focal === undefined) return undefined;
  const deviations = [...focal.deviations, ...scale.deviations];
  return {
    focalPx: focal.value * scale.value,
    uncertainty: Math.hypot(...deviations),
    source: `EXIF: ${[focal.source, known ? scale.source : "of an original of unknown size"].filter(Boolean).join(", ")}`,
  };
}

type Sides = readonly [width: number, height: number];

/** The focal length in pixels of the original. */
function focalOf(camera: Partial<Exif>, original: Sides, storedWidth: number | undefined): Estimate | undefined {
  const { focalLength35mm, focalLengthMm, sensorWidthMm, digitalZoom = 1 } = camera;
  const zoom = Math.max(digitalZoom, 1);
  const zoomed = Math.log(zoom) * Math.sqrt(ZOOM_FORGOTTEN * (1 - ZOOM_FORGOTTEN));
  const [long, short] = [Math.max(...original), Math.min(...original)];
  const estimates: Estimate[] = [];
  if (focalLength35mm !== undefined && focalLength35mm >= MIN_EQUIVALENT_MM) {
    const perDiagonal = Math.hypot(long, short) / Math.hypot(...FULL_FRAME_MM);
    // Some makers compare the widths, which gives the same in 3:2 only.
    const definition = 0.5 * Math.abs(Math.log(perDiagonal / (long / FULL_FRAME_MM[0])));
    const isFrame = long / short >= FRAME_ASPECTS[0] && long / short <= FRAME_ASPECTS[1];
    const value = focalLength35mm * perDiagonal;
    const deviations = [LENS, ROUNDING / focalLength35mm, definition, isFrame ? 0 : CUT_FRAME, zoomed];
    estimates.push({ value, deviations, source: `${shown(focalLength35mm)} mm (35 mm equivalent)` });
  }
  if (focalLengthMm !== undefined && sensorWidthMm !== undefined && storedWidth !== undefined) {
    const value = (focalLengthMm / sensorWidthMm) * storedWidth * zoom;
    const rounding = Number.isInteger(focalLengthMm) ? ROUNDING / focalLengthMm : 0;
    const source = `${shown(focalLengthMm)} mm on a sensor ${shown(sensorWidthMm)} mm wide`;
    estimates.push({ value, deviations: [LENS, SENSOR, rounding, zoomed], source });
  }
  const [first, second] = estimates;
  if (first === undefined || second === undefined) return first;
  const difference = Math.abs(Math.log(first.value / second.value));
  // Many cameras state a wrong resolution of the focal plane; the equivalent is written for people, who would notice.
  if (!(difference <= MAX_DIFFERENCE)) return { ...first, deviations: [...first.deviations, 0.5 * difference] };
  return Math.hypot(...first.deviations) <= Math.hypot(...second.deviations) ? first : second;
}

/** The factor of the focal length of the original. */
function scaleOf(image: Sides, original: Sides): Estimate | undefined {
  // Programs that turn the pixels may leave the sides in the EXIF data as they were.
  const turned: Sides = [original[1], original[0]];
  return resized(image, original) ?? resized(image, turned) ?? cropped(image, original) ?? cropped(image, turned);
}

function resized([width, height]: Sides, [fullWidth, fullHeight]: Sides): Estimate | undefined {
  const scales = [width / fullWidth, height / fullHeight] as const;
  const stretch = Math.abs(Math.log(scales[0] / scales[1]));
  const isCropOnly = (scales[0] === 1) !== (scales[1] === 1);
  if (stretch > MAX_STRETCH || isCropOnly) return undefined;
  const value = Math.sqrt(scales[0] * scales[1]);
  return { value, deviations: [0.5 * stretch], source: value === 1 ? "" : `resized by ${shown(value)}` };
}

function cropped([width, height]: Sides, [fullWidth, fullHeight]: Sides): Estimate | undefined {
  const largest = Math.max(width / fullWidth, height / fullHeight);
  if (largest > 1) return undefined;
  // A crop of a quarter of the area is rare, so that one that is smaller still was resized.
  if (largest < 0.5) {
    const source = `cropped and resized by about ${shown(largest)}`;
    return { value: largest, deviations: [0.5 * Math.log(2)], source };
  }
  const deviation = -Math.log(largest) * Math.sqrt(CROP_RESIZED * (1 - CROP_RESIZED));
  return { value: 1, deviations: [EDITED, deviation], source: "cropped" };
}

const shown = (number: number): string => String(Number(number.toPrecision(3)));
