/** Camera files of data sets, drivers and apps. */

import type { PinholeCamera } from "../types/inputs.js";
import { describe, failure, invalidArgument } from "../values/error.js";
import { isNumber, type JsonFile, keysText, parsedJson } from "../values/json.js";
import { isKind, isRecord } from "../values/kinds.js";
import type { ImageSize } from "../values/pixels.js";
import { type StatedUnit, unitOf } from "./depth-unit.js";
import { imageCamera, inPixels } from "./image-camera.js";
import { intrinsicsOf, type StatedCamera, sizeOf } from "./intrinsics.js";
import { isOther } from "./keys.js";
import { type CameraFileNames, type CameraPlace, camerasOf, noCamera } from "./statements.js";

/** The content of a camera file. */
export interface CameraFile extends PinholeCamera {
  /** Width in pixels of the image that the intrinsics belong to. */
  width?: number;
  /** Height in pixels of the image that the intrinsics belong to. */
  height?: number;
  /** Metres per unit of integer depth. */
  depthScale?: number;
  /** Relative standard deviation of the focal length, where it is a guess. */
  focalUncertainty?: number;
  /** Warnings about lens distortion, which the pinhole model does not include. */
  warnings: string[];
  /** Reasons why the intrinsics may belong to another image, or the depth scale mean another unit; absent without any. */
  doubts?: readonly string[];
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
}

/** Options for reading a camera file. */
export interface ReadCameraOptions {
  /** Image width in pixels: required for a field of view, otherwise compared with the width in the file. */
  width?: number | undefined;
  /** Image height in pixels: required for a field of view, otherwise compared with the height in the file. */
  height?: number | undefined;
  /** The image id in a BOP `scene_camera.json`, or the name of one of several cameras. */
  imageId?: string | number | undefined;
}

/** A camera file, whose intrinsics may depend on the image. */
export interface OpenCameraFile {
  /** The unit of integer depth, if the file states it. */
  unit: StatedUnit | undefined;
  /** The camera of an image, without doubts about the unit; without a size, that of the image in the file. */
  of(image: ImageSize | undefined): CameraFile;
}

/** More cameras than images of any scene of a data set. */
const MAX_CAMERAS = 1 << 16;

/** Keys that a sentence names at most, and that are looked up for it. */
const MAX_NAMED = 8;
const MAX_LOOKED_UP = 1000;

/**
 * Reads a camera file, JSON, text or NPY, each with or without the size of the image: what the table of keys in `keys.ts` and
 * the forms of text in `camera-text.ts` know. `depthScale` is metres per unit of depth, BOP's `depth_scale` millimetres per
 * unit. Intrinsics for an image of another size but the same shape are scaled.
 */
export async function parseCameraFile(
  content: JsonFile,
  { width, height, imageId }: ReadCameraOptions = {},
  names: CameraFileNames = { file: "camera", options: "options." },
): Promise<CameraFile> {
  const image = pair({ width: side(names, "width", width), height: side(names, "height", height) });
  const { unit, of } = await openCameraFile(content, imageId, names);
  const { doubts = [], ...file } = of(image);
  const all = unit?.doubt === undefined ? doubts : [...doubts, unit.doubt];
  return all.length === 0 ? file : { ...file, doubts: all };
}

/** Opens a camera file, without the size of the image of its depth map. */
export async function openCameraFile(
  content: JsonFile,
  imageId: unknown,
  names: CameraFileNames = { file: "camera", options: "options." },
): Promise<OpenCameraFile> {
  const id = idOf(names, imageId);
  const whole = await contentOf(names.file, content);
  if (!isRecord(whole) && !Array.isArray(whole)) throw noCamera(names, "JSON that is not an object");
  const json = entryOf(whole, id);
  const places = camerasOf(json);
  if (places.length > MAX_CAMERAS) {
    const remedy = "Pass the entry of one image.";
    throw failure("FILE_TOO_LARGE", names.file, `${places.length} cameras`, `at most ${MAX_CAMERAS}`, remedy);
  }
  if (places.length === 0) {
    throw noCamera(names, `an object with ${keysText(json)}`);
  }

  return {
    unit: commonUnit(idMatch(places, id, names) ?? places, names),
    of(image) {
      const { place, doubts } = chosen(places, id, image, names);
      const stated = intrinsicsOf(place.facts, image, names);
      const unit = unitOf(place.facts, names);
      const { camera, size, ...fit } = fitted(stated, image, names);
      const all = [...doubts, ...stated.doubts, ...fit.doubts];
      const unread = unreadOf(place, names.file);
      const uncertainty = place.facts.find(({ meaning }) => meaning === "focalUncertainty")?.value;
      return {
        ...camera,
        ...size,
        ...(unit === undefined ? {} : { depthScale: unit.metres }),
        ...(isNumber(uncertainty) ? { focalUncertainty: uncertainty } : {}),
        warnings: stated.distortions(camera, image ?? size),
        ...(all.length === 0 ? {} : { doubts: all }),
        ...(unread === undefined ? {} : { unread: [unread] }),
      };
    },
  };
}

/** The content as an object: of BOP's many images only that of the id, and what is a list by a name. */
function entryOf(json: Record<string, unknown> | unknown[], id: string | undefined): Record<string, unknown> {
  if (Array.isArray(json)) return json.some(isRecord) ? { cameras: json } : { K: json };
  const entry = id !== undefined && /^\d+$/.test(id) ? json[id] : undefined;
  return id !== undefined && isRecord(entry) ? { [id]: entry } : json;
}

/** The intrinsics for an image, and its size; without an image, as the file has them. */
function fitted({ camera, size }: StatedCamera, image: ImageSize | undefined, { file }: CameraFileNames) {
  if (image === undefined) return { camera: inPixels(camera, size), size, doubts: [] };
  return { ...imageCamera(file, camera, size, image), size: size === undefined ? undefined : image };
}

/** The parsed JSON of a camera file, or that with the meaning of its text or array. */
async function contentOf(argument: string, content: JsonFile): Promise<unknown> {
  if (typeof content !== "string" && !isKind<Uint8Array>(content, "Uint8Array")) return content;
  try {
    return parsedJson(argument, content);
  } catch (error) {
    // Most files are JSON.
    const { cameraContent } = await import("./camera-text.js");
    return cameraContent(argument, content, error);
  }
}

/** The cameras of the id; `undefined` without one. */
function idMatch(places: readonly CameraPlace[], id: string | undefined, names: CameraFileNames) {
  if (id === undefined) return undefined;
  // In BOP, ids have no leading zeros, unlike file names; nerfstudio has paths of files.
  const short = (text: string) => text.replace(/^.*[\\/]|\.\w+$/g, "").replace(/^0+(?=.)/, "");
  const exact = places.filter((place) => place.names.includes(id));
  const found =
    exact.length > 0 ? exact : places.filter((place) => place.names.some((name) => short(name) === short(id)));
  if (found.length > 0) return found;
  if (places.some((place) => place.names.length > 0)) throw severalCameras(places, JSON.stringify(id), names);
  const expected = "nothing: the file holds one camera, without an id";
  throw failure("INVALID_ARGUMENT", `${names.options}imageId`, JSON.stringify(id), expected, "Omit it.");
}

/** Words in the names of cameras to which depth mostly belongs, and in those of others, beside which that is certain. */
const preferred: readonly [name: RegExp, others?: RegExp][] = [
  [/depth/i],
  // Depth of stereo is that of the left camera.
  [/left/i, /left|right/i],
  [/^camera1$|^cam0$/i],
];

/** The camera of an image: by its id, by the size of the image, or by its name. */
function chosen(
  places: readonly CameraPlace[],
  id: string | undefined,
  image: ImageSize | undefined,
  names: CameraFileNames,
): { place: CameraPlace; doubts: string[] } {
  const candidates = idMatch(places, id, names) ?? places;
  const single = (found: readonly CameraPlace[]) => {
    const [first] = found;
    const same = first !== undefined && found.every((place) => isSame(place, first));
    return same ? { place: first, doubts: [] } : undefined;
  };
  const whole = single(candidates);
  if (whole !== undefined) return whole;
  const sized = candidates.map((place) => ({ place, size: sizeOf(place.facts) }));
  const matching = (fits: (size: ImageSize, image: ImageSize) => boolean) =>
    sized.flatMap(({ place, size }) => (image !== undefined && size !== undefined && fits(size, image) ? [place] : []));
  const exact = matching((size, { width, height }) => size.width === width && size.height === height);
  const similar = matching(
    (size, { width, height }) => Math.abs((size.width * height) / (size.height * width) - 1) < 0.01,
  );
  const bySize = single(exact) ?? (exact.length === 0 ? single(similar) : undefined);
  if (bySize !== undefined) return bySize;
  const rest = exact.length > 0 ? exact : candidates;
  for (const [word, others] of preferred) {
    const named = single(rest.filter((place) => place.names.some((name) => word.test(name))));
    if (named === undefined) continue;
    if (others !== undefined && rest.every((place) => place.names.some((name) => others.test(name)))) return named;
    const other = `The file holds ${places.length} cameras (${listOf(places.map(labelOf))}): ${labelOf(named.place)} was used. Pass the name of another one as imageId.`;
    return { ...named, doubts: [`${names.file}: ${other}`] };
  }
  throw severalCameras(candidates, "no image id for a file of several images or cameras", names);
}

/** Whether two cameras of a file state the same. */
const isSame = (a: CameraPlace, b: CameraPlace): boolean => a === b || essence(a) === essence(b);

const essence = ({ facts }: CameraPlace) =>
  JSON.stringify(
    facts.flatMap(({ meaning, value }) => (meaning === undefined || meaning === "up" ? [] : [[meaning, value]])),
  );

const labelOf = ({ names }: CameraPlace) => names.at(-1) ?? "";

function severalCameras(places: readonly CameraPlace[], found: string, { options }: CameraFileNames) {
  const all = [...new Set(places.map(labelOf))].sort((a, b) => a.length - b.length || (a < b ? -1 : 1));
  const expected = `one of ${listOf(all, 20)}`;
  const remedy = "Pass the id of the image of the depth map, or the name of its camera.";
  return failure("INVALID_ARGUMENT", `${options}imageId`, found, expected, remedy);
}

const listOf = (all: readonly string[], most = MAX_NAMED) =>
  `${all.slice(0, most).join(", ")}${all.length > most ? `, … (${all.length} in all)` : ""}`;

/** The unit of all cameras of a file. */
function commonUnit(places: readonly CameraPlace[], names: CameraFileNames): StatedUnit | undefined {
  const units = places.map(({ facts }) => unitOf(facts, names));
  return units.every((unit) => unit?.metres === units[0]?.metres) ? units[0] : undefined;
}

/** The sentence about numbers of a camera whose meaning is not known, and about gravity. */
function unreadOf({ facts }: CameraPlace, file: string): string | undefined {
  const up = facts.find(({ meaning }) => meaning === "up");
  const other = facts.filter(({ meaning }) => meaning === undefined).slice(0, MAX_LOOKED_UP);
  const unknown = other.filter(({ key, value }) => !isOther(key, value)).map(({ path }) => path);
  const sentences = [
    ...(unknown.length === 0 ? [] : [`${listOf(unknown)}: numbers whose meaning is not known.`]),
    ...(up === undefined ? [] : [`${up.path}: pass it as the option cameraUp, with meshUp, if it is to count.`]),
  ];
  return sentences.length === 0 ? undefined : `${file}: ${sentences.join(" ")}`;
}

const pair = ({ width, height }: { width: number | undefined; height: number | undefined }): ImageSize | undefined =>
  width === undefined || height === undefined ? undefined : { width, height };

function side({ options }: CameraFileNames, name: string, value: unknown): number | undefined {
  if (value === undefined || value === null) return undefined;
  if (isNumber(value) && Number.isSafeInteger(value) && value >= 0) return value;
  throw failure("INVALID_ARGUMENT", `${options}${name}`, describe(value), "an integer", "Pass the size in pixels.");
}

function idOf({ options }: CameraFileNames, imageId: unknown): string | undefined {
  if (imageId === undefined || imageId === null) return undefined;
  if (typeof imageId === "number" || typeof imageId === "string") return `${imageId}`;
  throw invalidArgument(`${options}imageId`, imageId, "a string or a number", "Pass a key of the file.");
}
