/** The intrinsics that the facts of a camera state. */
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import type { ImageSize } from "../values/pixels.js";
import { type CameraFileNames, noCamera, withoutSize } from "./camera-errors.js";
import type { Meaning } from "./keys.js";
import { distortionOf, isFisheye, isNoPerspective } from "./lens-distortion.js";
import { checkedPinhole, focalOfAngle, type Pinhole, resizedPinhole, skewedMatrix } from "./pinhole.js";
import { type Fact, numbersOf } from "./statements.js";

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

/** Keys of programs that count pixels from the edge of the first one; OpenCV's centre of it is at 0. */
const fromEdge = /^(fl_x|fl_y|camera_angle_x)$/;

/** Keys of MATLAB, which counts pixels from 1. */
const fromOne = /^(IntrinsicMatrix|RadialDistortion|PrincipalPoint)$/;

/** Skew that moves pixels by as much is warned of. */
const MAX_SKEW_PX = 0.5;

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
  const full = sizeOf(facts);
  const { camera, skewPx = 0, doubts = [] } = pinholeIn(facts, full ?? image, names);
  const shift = facts.some(({ key }) => fromEdge.test(key)) ? 0.5 : facts.some(({ key }) => fromOne.test(key)) ? 1 : 0;
  const shifted = { ...camera, cx: camera.cx - shift, cy: camera.cy - shift };
  return {
    ...regionOf(facts, shifted, full, image),
    doubts,
    distortions: (ofImage, size) => [...skewed(skewPx), ...distorted(facts, model, ofImage, size)],
  };
}

/** Intrinsics by focal lengths and a principal point, by a matrix, or by a field of view. */
function pinholeIn(
  facts: readonly Fact[],
  size: ImageSize | undefined,
  names: CameraFileNames,
): { camera: Pinhole; skewPx?: number; doubts?: string[] } {
  const fact = (...meanings: Meaning[]) => facts.find(({ meaning }) => meanings.includes(meaning as Meaning));
  const number = (meaning: Meaning): number | undefined => {
    const found = fact(meaning);
    if (found === undefined) return undefined;
    if (isNumber(found.value)) return found.value;
    throw noCamera(names, `${found.key} that is not a number`);
  };
  const focal = pairOf(fact("focal")?.value);
  const center = pairOf(fact("center")?.value);
  const aperture = apertureOf(facts);
  const middle = size && { cx: 0.5 * (size.width - 1), cy: 0.5 * (size.height - 1) };
  const principal = { cx: number("cx") ?? center?.[0], cy: number("cy") ?? center?.[1] };

  const isMetric = focal !== undefined && (aperture.x ?? aperture.y) !== undefined;
  const [fx, fy] = isMetric ? [] : [number("fx") ?? focal?.[0], number("fy") ?? number("fx") ?? focal?.[1]];
  const { cx, cy } = principal;
  if (fx !== undefined && fy !== undefined && cx !== undefined && cy !== undefined) {
    const skew = number("skew") ?? 0;
    return { camera: checkedPinhole(names.file, { fx, fy, cx, cy }), skewPx: Math.abs((skew * cy) / fy) };
  }
  const matrix = fact("matrix");
  if (matrix !== undefined) return matrixOf(matrix, names);
  if (isMetric) {
    if (size === undefined || middle === undefined) throw withoutSize("an aperture", names);
    const [horizontal, vertical] = [
      aperture.x && (focal[0] / aperture.x) * size.width,
      aperture.y && (focal[1] / aperture.y) * size.height,
    ];
    const [x, y] = [horizontal ?? vertical, vertical ?? horizontal];
    const camera = checkedPinhole(names.file, { fx: x, fy: y, cx: cx ?? middle.cx, cy: cy ?? middle.cy });
    return { camera, doubts: centred(fact("focal"), cx, names) };
  }
  // Depth Pro states the focal length alone, in pixels of the photo.
  if (fx !== undefined && fy !== undefined && cx === undefined && cy === undefined && fact("fx") === undefined) {
    const isInPixels = middle !== undefined && fx > 0.25 * Math.max(middle.cx, middle.cy);
    if (isInPixels) {
      return { camera: checkedPinhole(names.file, { fx, fy, ...middle }), doubts: centred(fact("focal"), cx, names) };
    }
    const remedy = "Write the focal lengths in pixels as fx and fy, or the width of the sensor as sensor_width.";
    throw failure(
      "INVALID_CAMERA",
      names.file,
      `${fact("focal")?.key} ${fx}, perhaps in millimetres`,
      "pixels",
      remedy,
    );
  }
  return fieldOfView(facts, size, names, principal);
}

/** The intrinsics in four numbers, or in a matrix by rows or by columns. */
function matrixOf({ key, value }: Fact, names: CameraFileNames) {
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

function fieldOfView(
  facts: readonly Fact[],
  size: ImageSize | undefined,
  names: CameraFileNames,
  { cx, cy }: { cx: number | undefined; cy: number | undefined },
): { camera: Pinhole; doubts: string[] } {
  const angle = (meaning: Meaning) => facts.find((fact) => fact.meaning === meaning);
  const [x, y, any] = [angle("fovX"), angle("fovY"), angle("fov")];
  const found = x ?? y ?? any;
  if (found === undefined) {
    const keys = facts.filter(({ meaning }) => meaning !== "model").map(({ path }) => path);
    throw noCamera(names, `an object with ${keys.slice(0, 12).join(", ") || "nothing"}`);
  }
  if (x === undefined && y === undefined) {
    const remedy = "Write it as fov_x (CARLA, Habitat) or fov_y (three.js, Unity, MuJoCo), in degrees.";
    throw failure("INVALID_CAMERA", names.file, `${found.key}, without its direction`, "fov_x or fov_y", remedy);
  }
  if (size === undefined) throw withoutSize("a field of view", names);
  const focalOf = (fact: Fact | undefined, side: number) =>
    fact && focalOfAngle(`${names.file}.${fact.key}`, degreesOf(fact), side);
  const [fx, fy] = [focalOf(x, size.width), focalOf(y, size.height)];
  const [middleX, middleY] = [0.5 * (size.width - 1), 0.5 * (size.height - 1)];
  const camera = { fx: fx ?? fy, fy: fy ?? fx, cx: cx ?? middleX, cy: cy ?? middleY };
  // Those who count from the edge are corrected by half a pixel, the middle is already right.
  const shift = cx === undefined && facts.some(({ key }) => fromEdge.test(key)) ? 0.5 : 0;
  const shifted = checkedPinhole(names.file, { ...camera, cx: camera.cx + shift, cy: camera.cy + shift });
  return { camera: shifted, doubts: isCentred.test(found.key) ? [] : centred(found, cx, names) };
}

/** Fields of view of images that are centred: by definition, or as renderers write them. */
const isCentred = /^(fovYDeg|fov_y_deg|camera_angle_x)$/;

/** The doubt of a principal point that is not stated. */
const centred = (fact: Fact | undefined, cx: number | undefined, { file }: CameraFileNames): string[] =>
  fact === undefined || cx !== undefined
    ? []
    : [`${file}: beside ${fact.key}, no principal point is stated: the middle of the image was used. Write cx and cy.`];

/** A field of view in degrees: small numbers are radians, unless the key says degrees. */
function degreesOf({ key, value }: Fact): unknown {
  if (!isNumber(value)) return value;
  const isRadians = /angle|rad/i.test(key) || (value <= Math.PI && !/deg/i.test(key));
  return isRadians ? (value * 180) / Math.PI : value;
}

/** A number for both axes, or one for each, also in a list of one camera. */
function pairOf(value: unknown): [number, number] | undefined {
  const numbers = isNumber(value) ? [value, value] : (numbersOf(value) ?? []);
  const [x, y = x] = numbers;
  return x !== undefined && y !== undefined && numbers.length <= 2 ? [x, y] : undefined;
}

/** The size of the sensor, in the unit of the focal length. */
function apertureOf(facts: readonly Fact[]): { x: number | undefined; y: number | undefined } {
  const value = (meaning: Meaning) => facts.find((fact) => fact.meaning === meaning)?.value;
  const pair = pairOf(value("aperture"));
  const [x, y] = [value("apertureX") ?? pair?.[0], value("apertureY") ?? pair?.[1]];
  return { x: isNumber(x) && x > 0 ? x : undefined, y: isNumber(y) && y > 0 ? y : undefined };
}

/** The size of the image that the intrinsics belong to, if the file states it. */
export function sizeOf(facts: readonly Fact[]): ImageSize | undefined {
  const first = <T>(meaning: Meaning, as: (value: unknown) => T | undefined): T | undefined =>
    facts
      .filter((fact) => fact.meaning === meaning)
      .map(({ value }) => as(value))
      .find((value) => value !== undefined);
  const [width, height] = [first("width", sideOf), first("height", sideOf)];
  if (width !== undefined && height !== undefined) return { width, height };
  const size = first("size", sidesOf);
  if (size !== undefined) {
    // MATLAB has rows first.
    const isByRows = facts.some(({ key }) => fromOne.test(key));
    return isByRows ? { width: size.height, height: size.width } : size;
  }
  const rows = first("shape", sidesOf);
  return rows && { width: rows.height, height: rows.width };
}

const sideOf = (value: unknown) => (isNumber(value) && Number.isSafeInteger(value) && value > 0 ? value : undefined);

function sidesOf(value: unknown): ImageSize | undefined {
  const text = typeof value === "string" ? value.split(/\s*[x×,]\s*/i).map(Number) : value;
  const [width, height] = (Array.isArray(text) ? text : []).map(sideOf);
  return width === undefined || height === undefined ? undefined : { width, height };
}

/** The camera of the region of the sensor that was read out, and of the pixels that were binned, in ROS' CameraInfo. */
function regionOf(
  facts: readonly Fact[],
  camera: Pinhole,
  size: ImageSize | undefined,
  image: ImageSize | undefined,
): { camera: Pinhole; size: ImageSize | undefined } {
  const value = (meaning: Meaning) => facts.find((fact) => fact.meaning === meaning)?.value;
  const isWhole =
    size !== undefined && image !== undefined && size.width === image.width && size.height === image.height;
  if (size === undefined || isWhole) return { camera, size };
  const region = value("region");
  const { x_offset = 0, y_offset = 0, width = 0, height = 0 } = isRecord(region) ? region : {};
  const read = sidesOf([width, height]);
  const part = read ?? size;
  const [left, top] = read === undefined ? [0, 0] : [Number(x_offset), Number(y_offset)];
  const cropped = { ...camera, cx: camera.cx - left, cy: camera.cy - top };
  const [x, y] = [sideOf(value("binningX")) ?? 1, sideOf(value("binningY")) ?? 1];
  const binned = { width: Math.floor(part.width / x), height: Math.floor(part.height / y) };
  return { camera: resizedPinhole(cropped, part, binned), size: binned };
}

/** The names of the model of the camera and of its distortion. */
function modelOf(facts: readonly Fact[]): string {
  const named = facts.flatMap(({ meaning, key, value }) =>
    meaning !== "model"
      ? []
      : typeof value === "string"
        ? [value]
        : /fisheye/i.test(key) && (value === true || value === 1)
          ? [key]
          : [],
  );
  return named.find((name) => isFisheye(name) || isNoPerspective(name)) ?? named[0] ?? "";
}

const skewed = (skewPx: number) =>
  skewPx <= MAX_SKEW_PX
    ? []
    : [
        `The camera has skew, which is not modelled: it moves pixels by up to ${skewPx.toFixed(1)}. Pass a rectified depth map and mask, and their K.`,
      ];

function distorted(facts: readonly Fact[], model: string, camera: Pinhole, size: ImageSize | undefined): string[] {
  const lists = facts
    .filter(({ meaning }) => meaning === "distortion")
    .map((fact) => ({ ...fact, numbers: numbersOf(fact.value) ?? [] }));
  const single = facts.filter((fact) => fact.meaning === "coefficient" && isNumber(fact.value));
  const named = (name: string) => Number(single.find(({ key }) => key.toLowerCase().endsWith(name))?.value ?? 0);
  const order = isFisheye(model) ? ["k1", "k2", "k3", "k4"] : ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
  const of = (name: RegExp) => lists.find(({ key }) => name.test(key))?.numbers;
  const [radial, tangential = []] = [of(/^radial/i), of(/^tangential/i)];
  const list =
    radial === undefined
      ? lists[0]?.numbers
      : [radial[0] ?? 0, radial[1] ?? 0, tangential[0] ?? 0, tangential[1] ?? 0, radial[2] ?? 0];
  const coefficients = list ?? order.map(named);
  const keys =
    lists.length > 0 ? lists.map(({ key }) => key) : single.filter(({ value }) => value !== 0).map(({ key }) => key);
  const ofModel = isFisheye(model) ? [model] : [];
  const message = distortionOf({ keys: [...ofModel, ...keys], model, coefficients }, camera, size);
  return message === undefined ? [] : [message];
}
