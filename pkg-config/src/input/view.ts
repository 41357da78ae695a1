/** Reads what a camera saw: the depth map or the point map, the photo and the camera. */
import { depthOfRays } from "../camera/ray-distance.js";
import type { CoreInput, CoreView } from "../modules/core-input.js";
import type { FileReaders } from "../modules/readers.js";
import type { DepthImage } from "../types/inputs.js";
import type { InputNotes } from "../types/results.js";
import { invalidArgument } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import { oneOf, withoutUndefined } from "../values/validation.js";
import { cameraOf, type ResolvedCamera } from "./camera.js";
import { checkSides, DEFAULT_SCALE, readDepth, readPointMap, type SizedArray, unknownUnit } from "./depth.js";
import { depthKindNames, isAffineInvariant } from "./formats.js";
import { type ReadPhoto, readPhoto, readPhotoExif } from "./photo.js";

/** An input for the core, and what its files say. */
export interface Resolved<T> {
  core: T;
  notes: InputNotes;
}

/** The properties of a view. */
export const viewProperties: readonly string[] = [
  "depth",
  "depthScale",
  "depthKind",
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
  const { pointMap } = input;
  return pointMap === undefined ? depthView(input, readers) : pointMapView(input, pointMap, readers);
}

async function depthView(input: Record<string, unknown>, readers: FileReaders): Promise<Resolved<CoreView>> {
  const size = { width: input.width as number | undefined, height: input.height as number | undefined };
  const depthScale = input.depthScale as number | undefined;
  const depthKind = oneOf("depthKind", input.depthKind ?? "metric", depthKindNames, "INVALID_ARGUMENT");
  const camera = await cameraOf(input);
  const { integerDepthScale } = camera;
  const reading = { depthScale, integerDepthScale, depthKind };
  const { data, unit, camera: inDepth, ...sides } = await readDepth(input.depth, size, reading, readers);
  const isFile = data !== input.depth && !isRecord(input.depth);
  const isFloat = isTypedArray(data, "Float32Array");
  // Integers of an unknown unit are read as they are.
  const isMetric = depthKind === "metric" || depthKind === "ray-distance";
  const integerScale = isMetric ? integerDepthScale : 1;
  const photo = await readPhoto(input.image, sides, readers);
  const { image } = photo;
  const exif = camera.isGiven ? undefined : await readPhotoExif(input.image, readers);
  const hints = { inDepth, photo: exif && image && { exif, size: image } };
  const resolved = camera.resolve(sides.width, sides.height, hints);
  // The readers have already scaled the values of a file.
  const scale = isFile ? undefined : (depthScale ?? (isFloat ? undefined : integerScale));
  const read =
    depthKind === "ray-distance" && resolved.camera !== undefined
      ? { depth: depthOfRays(data, sides.width as number, resolved.camera, scale ?? (isFloat ? 1 : DEFAULT_SCALE)) }
      : { depth: data, depthScale: scale, depthKind: isMetric ? undefined : depthKind };
  return viewOf(read, sides, photo, resolved, unit);
}

async function pointMapView(
  input: Record<string, unknown>,
  pointMap: unknown,
  readers: FileReaders,
): Promise<Resolved<CoreView>> {
  const other = ["depth", "depthScale"].find((name) => input[name] !== undefined);
  if (other !== undefined) {
    const remedy = `Omit ${other}: the point map contains the depth, in metres.`;
    throw invalidArgument(other, input[other], "a point map or depth, but not both", remedy);
  }
  const kinds = depthKindNames.filter((kind) => !isAffineInvariant(kind) && kind !== "ray-distance");
  const depthKind = oneOf("depthKind", input.depthKind ?? "metric", kinds, "INVALID_ARGUMENT");
  const { data, ...sides } = readPointMap(pointMap, input as { width?: number; height?: number });
  const photo = await readPhoto(input.image, sides, readers);
  const isMetric = depthKind === "metric";
  const read = { pointMap: data, depthKind: isMetric ? undefined : depthKind };
  const camera = await cameraOf(input);
  // Intrinsics that were not given are fitted to the point map.
  const resolved = camera.isGiven ? camera.resolve(sides.width, sides.height) : { camera: undefined, warnings: [] };
  const unit = isMetric ? { metres: 1, source: "point map", isAssumed: false } : unknownUnit(depthKind);
  return viewOf(read, sides, photo, resolved, unit);
}

function viewOf(
  depth: { [K in "depth" | "depthScale" | "depthKind" | "pointMap"]?: CoreInput[K] | undefined },
  { width, height }: Omit<SizedArray<unknown>, "data">,
  { image, imageReading }: ReadPhoto,
  { camera, focalDeviation, source, warnings }: ResolvedCamera,
  depthUnit: DepthImage["unit"],
): Resolved<CoreView> {
  const view = withoutUndefined({ ...depth, width, height, image, camera, focalDeviation });
  const notes = { warnings, colors: [], depthUnit, ...withoutUndefined({ cameraSource: source, imageReading }) };
  return { core: view as CoreView, notes };
}
