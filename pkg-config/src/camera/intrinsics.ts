/** The intrinsics that the facts of a camera state. */
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import type { ImageSize } from "../values/pixels.js";
import type { Meaning } from "./keys.js";
import { distortionOf, isFisheye, isNoPerspective } from "./lens-distortion.js";
import { checkedPinhole, focalOfAngle, MAX_SKEW_PX, type Pinhole, resizedPinhole, skewedMatrix } from "./pinhole.js";
import { type CameraFileNames, type Fact, noCamera, numbersOf } from "./statements.js";

/** What a camera file states of one camera. */
export interface StatedCamera {
  /** Its intrinsics, in pixels or in sizes of the image. */
  camera: Pinhole;
  /** The size of the image that they belong to, if the file states it. */
  size: ImageSize | undefined;
  doubts: readonly string[];
  /** Why the camera is no pinhole in an image. */
  distortions(camera: Pinhole, size: ImageSize | undefined): string[];
}

/** Intrinsics as one of the forms states them. */
interface Read {
  camera: Pinhole;
  /** By how many pixels the skew moves a pixel. */
  skewPx?: number;
  /** The key beside which there is no principal point. */
  centredBy?: string | undefined;
  doubts?: readonly string[];
}

/** Keys of programs that count pixels from the edge of the first one; OpenCV's centre of it is at 0. */
const fromEdge = /^(fl_x|fl_y|camera_angle_x)$/;

/** Keys of MATLAB, which counts pixels from 1. */
const fromOne = /^(IntrinsicMatrix|RadialDistortion|PrincipalPoint)$/;

/** Fields of view of images that are centred: by definition, or as renderers write them. */
const isCentred = /^(fovYDeg|fov_y_deg|camera_angle_x)$/;

const factOf = (facts: readonly Fact[], ...meanings: Meaning[]) =>
  meanings.map((meaning) => facts.find((fact) => fact.meaning === meaning)).find((fact) => fact !== undefined);

/**
 * The intrinsics of a camera.
 * @param image the size of the image, where the file does not state it
 */
export function intrinsicsOf(
  facts: readonly Fact[],
  image: ImageSize | undefined,
  names: CameraFileNames,
): StatedCamera {
  const model = modelOf(facts);
  if (isNoPerspective(model)) {
    const remedy = "Rectify depth map, mask and photo to a pinhole camera, and pass its K.";
    throw failure("UNSUPPORTED_FORMAT", names.file, `a camera of the model ${model}`, "a pinhole camera", remedy);
  }
  const size = sizeOf(facts);
  const read = pinholeIn(facts, size ?? image, names);
  const { camera, skewPx = 0, centredBy, doubts = [] } = read;

  const has = (keys: RegExp) => facts.some(({ key }) => keys.test(key));
  const shift = centredBy !== undefined ? 0 : has(fromEdge) ? 0.5 : has(fromOne) ? 1 : 0;
  const shifted = { ...camera, cx: camera.cx - shift, cy: camera.cy - shift };
  // Metashape counts from the middle of the image.
  const middle = size !== undefined && has(/^f$/) && isNearCorner(camera, size) ? size : { width: 1, height: 1 };
  const placed = { ...shifted, cx: shifted.cx + 0.5 * (middle.width - 1), cy: shifted.cy + 0.5 * (middle.height - 1) };
  const doubt = `${names.file}: beside ${centredBy}, no principal point is stated: the middle of the image was used. Write cx and cy.`;
  return {
    ...regionOf(facts, placed, size, image),
    doubts: [...doubts, ...(centredBy === undefined || isCentred.test(centredBy) ? [] : [doubt])],
    distortions: (ofImage, imageSize) => [...skewed(skewPx), ...distorted(facts, model, ofImage, imageSize)],
  };
}

const isNearCorner = ({ cx, cy }: Pinhole, { width, height }: ImageSize) =>
  Math.abs(cx) < 0.1 * width && Math.abs(cy) < 0.1 * height;

/** Intrinsics by focal lengths and a principal point, by a matrix, by the size of the sensor, or by a field of view. */
function pinholeIn(facts: readonly Fact[], size: ImageSize | undefined, names: CameraFileNames): Read {
  const number = (meaning: Meaning): number | undefined => {
    const found = factOf(facts, meaning);
    if (found === undefined || isNumber(found.value)) return found?.value as number | undefined;
    throw noCamera(names, `${found.key} that is not a number`);
  };
  const focal = factOf(facts, "focal");
  const [center, lengths, sensor] = [pairOf(factOf(facts, "center")), pairOf(focal), sensorOf(facts)];
  const [cx, cy] = [number("cx") ?? center?.[0], number("cy") ?? center?.[1]];
  const isInPixels = sensor === undefined;
  const fx = number("fx") ?? (isInPixels ? lengths?.[0] : undefined);
  const fy = number("fy") ?? (isInPixels ? (lengths?.[1] ?? fx) : undefined);
  if (fx !== undefined && fy !== undefined && cx !== undefined && cy !== undefined) {
    return {
      camera: checkedPinhole(names.file, { fx, fy, cx, cy }),
      skewPx: Math.abs(((number("skew") ?? 0) * cy) / fy),
    };
  }
  const matrix = factOf(facts, "matrix", "projection");
  if (matrix !== undefined) return matrixOf(matrix, names);

  const alone = cx === undefined && cy === undefined ? (factOf(facts, "fx") ?? focal) : undefined;
  const found = alone ?? factOf(facts, "fovX", "fovY", "fov");
  const isPartial = alone === undefined && (fx ?? fy) !== undefined;
  if (found === undefined || isPartial) {
    const keys = facts.filter(({ meaning }) => meaning !== "model").map(({ path }) => path);
    throw noCamera(names, `an object with ${keys.slice(0, 12).join(", ") || "nothing"}`);
  }
  if (size === undefined) throw withoutSize(alone === undefined ? "a field of view" : `${found.key} alone`, names);
  const stated = lengths ?? (fx !== undefined && fy !== undefined ? [fx, fy] : undefined);
  const isFocal = alone !== undefined && stated !== undefined;
  const focals: Focals = isFocal
    ? focalLengths(found.key, stated, sensor && { ...sensor, fit: factOf(facts, "fit")?.value }, size, names)
    : focalsOfAngles(facts, size, names);
  const { x, y, doubts = [] } = focals;
  const middle = { cx: cx ?? 0.5 * (size.width - 1), cy: cy ?? 0.5 * (size.height - 1) };
  const camera = checkedPinhole(names.file, { fx: x ?? y, fy: y ?? x, ...middle });
  return { camera, centredBy: cx === undefined ? found.key : undefined, doubts };
}

/** The intrinsics in four numbers, or in a matrix by rows or by columns. */
function matrixOf({ key, value }: Fact, names: CameraFileNames): Read {
  const numbers = numbersOf(value) ?? [];
  if (numbers.length === 4) {
    const [fx, fy, cx, cy] = numbers;
    return { camera: checkedPinhole(names.file, { fx, fy, cx, cy }) };
  }
  // By columns, what is a row here is a column.
  const rows = Array.isArray(value) && Array.isArray(value[0]) ? value.length : 3;
  const columns = { 9: 3, 12: rows === 3 ? 4 : undefined, 16: 4 }[numbers.length];
  if (columns === undefined) throw noCamera(names, `${key} that is not 3 × 3 numbers`);
  const square = [0, 1, 2].flatMap((row) => [0, 1, 2].map((column) => numbers[columns * row + column] as number));
  const transposed = [0, 3, 6, 1, 4, 7, 2, 5, 8].map((i) => square[i] as number);
  const isByColumns = (square[6] !== 0 || square[7] !== 0) && square[2] === 0 && square[5] === 0;
  return skewedMatrix(names.file, isByColumns ? transposed : square);
}

/** Focal lengths across the image and down. */
interface Focals {
  x?: number | undefined;
  y?: number | undefined;
  doubts?: readonly string[];
}

/** Difference of focal lengths, as a logarithm, from which pixels are not square. */
const NOT_SQUARE = 0.01;

/** Focal lengths in pixels alone, as Depth Pro states them, or in the unit of the sensor's size. */
function focalLengths(
  key: string,
  [x, y]: readonly [number, number],
  sensor: (Partial<Record<"x" | "y", number>> & { fit: unknown }) | undefined,
  { width, height }: ImageSize,
  { file }: CameraFileNames,
): Focals {
  if (sensor !== undefined) {
    const focals = { x: sensor.x && (x / sensor.x) * width, y: sensor.y && (y / sensor.y) * height };
    if (!focals.x || !focals.y || x !== y || Math.abs(Math.log(focals.x / focals.y)) < NOT_SQUARE) return focals;
    // Renderers have square pixels, and ignore the side of the sensor that doesn't fit: mostly the height.
    const isByHeight = /^vertical$/i.test(`${sensor.fit}`);
    const isByLonger = /^auto$/i.test(`${sensor.fit}`) && height > width;
    const focal = isByHeight ? focals.y : isByLonger ? (focals.x * height) / width : focals.x;
    const side = isByHeight ? "height" : "width";
    const doubt = `${file}: a sensor of ${sensor.x} × ${sensor.y} has another shape than the image of ${width} × ${height}: pixels were taken for squares, and its ${side} counted. Write fx and fy in pixels.`;
    return { x: focal, y: focal, doubts: sensor.fit === undefined ? [doubt] : [] };
  }
  if (Math.max(x, y) > 0.125 * Math.max(width, height)) return { x, y };
  const remedy = "Write the focal lengths in pixels as fx and fy, or the width of the sensor as sensor_width.";
  throw failure("INVALID_CAMERA", file, `${key} ${x}, perhaps in millimetres`, "pixels", remedy);
}

/** Focal lengths of fields of view, across the image or down. */
function focalsOfAngles(facts: readonly Fact[], { width, height }: ImageSize, { file }: CameraFileNames) {
  const [x, y] = [factOf(facts, "fovX"), factOf(facts, "fovY")];
  if (x === undefined && y === undefined) {
    const remedy = "Write it as fov_x (CARLA, Habitat) or fov_y (three.js, Unity, MuJoCo), in degrees.";
    throw failure(
      "INVALID_CAMERA",
      file,
      `${factOf(facts, "fov")?.key}, without its direction`,
      "fov_x or fov_y",
      remedy,
    );
  }
  const focalOf = (fact: Fact | undefined, side: number) =>
    fact && focalOfAngle(`${file}.${fact.key}`, degreesOf(fact), side);
  return { x: focalOf(x, width), y: focalOf(y, height) };
}

/** A field of view in degrees: small numbers are radians, unless the key says degrees. */
function degreesOf({ key, value }: Fact): unknown {
  const isRadians = isNumber(value) && (/angle|rad/i.test(key) || (value <= Math.PI && !/deg/i.test(key)));
  return isRadians ? (value * 180) / Math.PI : value;
}

/** A number for both axes, or one for each, also in a list of one camera. */
function pairOf(fact: Fact | undefined): [number, number] | undefined {
  const numbers = isNumber(fact?.value) ? [fact.value] : (numbersOf(fact?.value) ?? []);
  const [x, y = x] = numbers;
  return x !== undefined && y !== undefined && numbers.length <= 2 ? [x, y] : undefined;
}

/** The size of the sensor, in the unit of the focal length. */
function sensorOf(facts: readonly Fact[]): Partial<Record<"x" | "y", number>> | undefined {
  const pair = pairOf(factOf(facts, "aperture"));
  const [x, y] = [
    pairOf(factOf(facts, "apertureX"))?.[0] ?? pair?.[0],
    pairOf(factOf(facts, "apertureY"))?.[0] ?? pair?.[1],
  ];
  const isKnown = [x, y].some((side) => side !== undefined && side > 0);
  return isKnown ? { ...(x === undefined ? {} : { x }), ...(y === undefined ? {} : { y }) } : undefined;
}

/** The size of the image that the intrinsics belong to, if the file states it. */
export function sizeOf(facts: readonly Fact[]): ImageSize | undefined {
  const first = <T>(meaning: Meaning, as: (value: unknown) => T | undefined): T | undefined =>
    facts.flatMap((fact) => (fact.meaning === meaning ? [as(fact.value)] : [])).find((value) => value !== undefined);
  const [width, height] = [first("width", sideOf), first("height", sideOf)];
  if (width !== undefined && height !== undefined) return { width, height };
  // MATLAB has rows first.
  const isByRows = facts.some(({ key }) => fromOne.test(key));
  const size = first("size", sidesOf);
  const rows = isByRows ? size : first("shape", sidesOf);
  return isByRows || size === undefined ? rows && { width: rows.height, height: rows.width } : size;
}

const sideOf = (value: unknown) => (isNumber(value) && Number.isSafeInteger(value) && value > 0 ? value : undefined);

function sidesOf(value: unknown): ImageSize | undefined {
  const sides = typeof value === "string" ? value.split(/\s*[x×,]\s*/i).map(Number) : value;
  const [width, height] = (Array.isArray(sides) ? sides : []).map(sideOf);
  return width === undefined || height === undefined ? undefined : { width, height };
}

/** The camera of the region of the sensor that was read out, and of the pixels that were binned, in ROS' CameraInfo. */
function regionOf(
  facts: readonly Fact[],
  camera: Pinhole,
  size: ImageSize | undefined,
  image: ImageSize | undefined,
): { camera: Pinhole; size: ImageSize | undefined } {
  const isWhole = size?.width === image?.width && size?.height === image?.height;
  if (size === undefined || isWhole) return { camera, size };
  const region = factOf(facts, "region")?.value;
  const { x_offset = 0, y_offset = 0, width, height } = isRecord(region) ? region : {};
  const read = sidesOf([width, height]);
  const [left, top] = read === undefined ? [0, 0] : [Number(x_offset), Number(y_offset)];
  const cropped = { ...camera, cx: camera.cx - left, cy: camera.cy - top };

  const part = read ?? size;
  const [x, y] = [sideOf(factOf(facts, "binningX")?.value) ?? 1, sideOf(factOf(facts, "binningY")?.value) ?? 1];
  const binned = { width: Math.floor(part.width / x), height: Math.floor(part.height / y) };
  return { camera: resizedPinhole(cropped, part, binned), size: binned };
}

/** The name of the model of the camera or of its distortion. */
function modelOf(facts: readonly Fact[]): string {
  const named = facts.flatMap(({ meaning, key, value }) => {
    if (meaning !== "model") return [];
    return typeof value === "string" ? [value] : /fisheye/i.test(key) && (value === true || value === 1) ? [key] : [];
  });
  return named.find((name) => isFisheye(name) || isNoPerspective(name)) ?? named[0] ?? "";
}

const skewed = (skewPx: number) =>
  skewPx <= MAX_SKEW_PX
    ? []
    : [
        `The camera has skew, which is not modelled: it moves pixels by up to ${skewPx.toFixed(1)}. Pass a rectified depth map and mask, and their K.`,
      ];

/** Coefficients in OpenCV's order, and those of a fisheye lens. */
const orders = {
  pinhole: ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"],
  fisheye: ["k1", "k2", "k3", "k4"],
} as const;

function distorted(facts: readonly Fact[], model: string, camera: Pinhole, size: ImageSize | undefined): string[] {
  const lists = facts.flatMap(({ meaning, key, value }) =>
    meaning === "distortion" ? [{ key, numbers: numbersOf(value) ?? [] }] : [],
  );
  const single = facts.filter(({ meaning, value }) => meaning === "coefficient" && isNumber(value) && value !== 0);
  const isFish = isFisheye(model);
  const named = orders[isFish ? "fisheye" : "pinhole"].map(
    (name) => (single.find(({ key }) => key.toLowerCase().endsWith(name))?.value ?? 0) as number,
  );
  const of = (name: RegExp) => lists.find(({ key }) => name.test(key))?.numbers;
  const [radial, [p1 = 0, p2 = 0] = []] = [of(/^radial/i), of(/^tangential/i)];
  const [k1 = 0, k2 = 0, k3 = 0] = radial ?? [];
  const coefficients = radial === undefined ? (lists[0]?.numbers ?? named) : [k1, k2, p1, p2, k3];
  const keys = [...(isFish ? [model] : []), ...(lists.length > 0 ? lists : single).map(({ key }) => key)];
  const message = distortionOf({ keys, model, coefficients }, camera, size);
  return message === undefined ? [] : [message];
}

/** The error for intrinsics that depend on the size of the image. */
function withoutSize(found: string, { options }: CameraFileNames) {
  const remedy = "Pass the width and height of the depth map in pixels.";
  return failure("INVALID_ARGUMENT", `${options}width`, `${found} without image size`, "width and height", remedy);
}
