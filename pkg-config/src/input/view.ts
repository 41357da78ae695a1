/** Reads what a camera saw: the depth map or the point map, the photo and the camera. */

import { depthOfRays, type Pinhole } from "../camera/pinhole.js";
import type { CoreInput, CoreView } from "../modules/core-input.js";
import type { FileReaders } from "../modules/readers.js";
import type { DepthCoding, DepthImage, DepthKind, ReadDepthOptions } from "../types/inputs.js";
import type { InputNotes } from "../types/results.js";
import { invalidArgument } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import { oneOf, withoutUndefined } from "../values/validation.js";
import { type Camera, cameraOf, type ResolvedCamera, unitOf } from "./camera.js";
import { doubtOfCode } from "./coded-depth.js";
import {
  checkSides,
  metresPerUnit,
  readDepth,
  readPointMap,
  type SizedArray,
  type StatedSize,
  unknownUnit,
} from "./depth.js";
import { depthKindNames, isAffineInvariant } from "./formats.js";
import { photoHint } from "./lens.js";
import { type ReadPhoto, readPhoto, readPhotoExif } from "./photo.js";

/** An input for the core, and what its files say. */
export interface Resolved<T> {
  core: T;
  notes: InputNotes;
}

/** The properties of the code of a depth map. */
const codingNames = ["depthCode", "depthNear", "depthFar"] as const;

/** The properties of a view. */
export const viewProperties: readonly string[] = [
  "depth",
  "depthScale",
  "depthKind",
  ...codingNames,
  "pointMap",
  "width",
  "height",
  "camera",
  "cameraFile",
  "imageId",
  "image",
];

/**
 * Reads a view, whose property names have been checked. Readers are loaded only if a file needs them.
 * @throws {@link Sim3AlignError} for arguments of the wrong type, and the errors of the file readers
 */
export async function readView(input: Record<string, unknown>, readers: FileReaders): Promise<Resolved<CoreView>> {
  checkSides("", input);
  const camera = await cameraOf(input);
  const measured = await readMeasured(input, camera.unit?.metres, readers);
  const photo = await readPhoto(input.image, measured, readers);
  const { camera: pinhole, ...lens } = await resolveCamera(camera, measured, photo, input, readers);

  const { width, height, unit, unread = [] } = measured;
  const depth = measured.rays === undefined || pinhole === undefined ? measured.core : measured.rays(pinhole);
  const view = { ...depth, width, height, image: photo.image, camera: pinhole, focalDeviation: lens.focalDeviation };
  const { imageReading } = photo;
  const { unit: depthUnit, warnings: ofUnit } = unitOf(unit, camera);
  const doubt =
    measured.readings === undefined ? undefined : await doubtOfCode(measured.readings, { width, height }, depthUnit);
  const [doubts, warnings] = doubt?.isUncertain ? [[doubt.warning], []] : [[], doubt ? [doubt.warning] : []];
  const notes = {
    warnings: [...warnings, ...lens.warnings, ...ofUnit],
    unread: [...unread, ...(lens.unread ?? [])],
    colors: [],
    doubts,
    depthUnit,
  };
  return {
    core: withoutUndefined(view) as CoreView,
    notes: { ...notes, ...withoutUndefined({ cameraSource: lens.source, imageReading }) },
  };
}

/** A depth map or a point map. */
interface Measured extends Omit<SizedArray<unknown>, "data"> {
  core: { [K in "depth" | "depthScale" | "depthKind" | "pointMap"]?: CoreInput[K] | undefined };
  unit: DepthImage["unit"];
  /** The camera in the file of the depth; `"fitted"` for a point map, to which the core fits one. */
  camera: Pinhole | "fitted" | undefined;
  /** Content of the file that its reader does not know. */
  unread?: readonly string[] | undefined;
  /** The lengths of a depth map, which may be a code. */
  readings?: Float32Array | Uint16Array | undefined;
  /** Converts distances along rays to depth. */
  rays?: (camera: Pinhole) => Measured["core"];
}

async function readMeasured(
  input: Record<string, unknown>,
  integerDepthScale: number | undefined,
  readers: FileReaders,
): Promise<Measured> {
  const { pointMap, depth, width, height } = input;
  const size = { width, height } as StatedSize;
  if (pointMap === undefined) {
    const depthKind = oneOf("depthKind", input.depthKind ?? "metric", depthKindNames, "INVALID_ARGUMENT");
    const depthScale = input.depthScale as number | undefined;
    const { depthCode, depthNear, depthFar } = input as DepthCoding;
    const reading = { depthScale, integerDepthScale, depthKind, depthCode, depthNear, depthFar };
    return depthView(depth, size, reading, readers);
  }
  const other = ["depth", "depthScale", ...codingNames].find((name) => input[name] !== undefined);
  if (other !== undefined) {
    const remedy = `Omit ${other}: the point map contains the depth, in metres.`;
    throw invalidArgument(other, input[other], "a point map or depth, but not both", remedy);
  }
  const kinds = depthKindNames.filter((kind) => !isAffineInvariant(kind) && kind !== "ray-distance");
  return pointMapView(pointMap, size, oneOf("depthKind", input.depthKind ?? "metric", kinds, "INVALID_ARGUMENT"));
}

async function depthView(
  depth: unknown,
  size: StatedSize,
  reading: ReadDepthOptions & { depthKind: DepthKind },
  readers: FileReaders,
): Promise<Measured> {
  const { depthScale, integerDepthScale, depthKind } = reading;
  const { data, ...read } = await readDepth(depth, size, reading, readers);
  const isFile = (data !== depth && !isRecord(depth)) || reading.depthCode !== undefined;
  const isFloat = isTypedArray(data, "Float32Array");
  // Integers of an unknown unit are read as they are.
  const isMetric = depthKind === "metric" || depthKind === "ray-distance";
  const integerScale = isMetric ? integerDepthScale : 1;
  // The readers have already scaled the values of a file, and of a code.
  const scale = isFile ? undefined : (depthScale ?? (isFloat ? undefined : integerScale));
  const readings = isMetric && reading.depthCode === undefined ? data : undefined;
  const measured = { camera: undefined, readings, ...read };
  const core = { depth: data, depthScale: scale, depthKind: isMetric ? undefined : depthKind };
  if (depthKind !== "ray-distance") return { ...measured, core };
  const metres = metresPerUnit(data, scale);
  const rays = (camera: Pinhole) => ({ depth: depthOfRays(data, read.width as number, camera, metres) });
  return { ...measured, core, rays };
}

function pointMapView(pointMap: unknown, size: StatedSize, depthKind: DepthKind): Measured {
  const { data, ...sides } = readPointMap(pointMap, size);
  const isMetric = depthKind === "metric";
  const unit = isMetric ? { metres: 1, source: "point map", isAssumed: false } : unknownUnit(depthKind);
  return { ...sides, core: { pointMap: data, depthKind: isMetric ? undefined : depthKind }, unit, camera: "fitted" };
}

/** The camera of what was measured: the stated one, or that of the depth file, of the photo's EXIF data, or a guess. */
async function resolveCamera(
  camera: Camera,
  { width, height, camera: inDepth }: Measured,
  { image }: ReadPhoto,
  input: Record<string, unknown>,
  readers: FileReaders,
): Promise<ResolvedCamera> {
  if (camera.isGiven) return camera.resolve(width, height);
  if (inDepth === "fitted") return { camera: undefined, warnings: [] };
  const exif = await readPhotoExif(input.image, readers);
  return camera.resolve(width, height, { inDepth, photo: await photoHint(exif, image) });
}
