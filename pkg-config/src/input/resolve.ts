/** Converts inputs to the typed arrays and numbers of the core. */

import type { FileReaders } from "../modules/readers.js";
import type { InputNotes } from "../types/results.js";
import { invalidArgument } from "../values/error.js";
import { checkNames, isRecord, isTypedArray, oneOf, withoutUndefined } from "../values/values.js";
import { cameraOf, type ResolvedCamera } from "./camera.js";
import type { Photo } from "./colors.js";
import type { CoreInput, CoreView } from "./core-input.js";
import { checkSides, readDepth, readPointMap, type SizedArray } from "./depth.js";
import { depthKinds, isAffineInvariant } from "./depth-kind.js";
import { readMask } from "./mask.js";
import { readCoreMesh } from "./mesh.js";
import { readPhoto, readPhotoExif } from "./photo.js";

/** A resolved input, and what its files say. */
export interface ResolvedInput {
  core: CoreInput;
  notes: InputNotes;
}

/** The properties of a frame: those of an input but the mesh. */
export const frameProperties: readonly string[] = [
  "depth",
  "depthScale",
  "depthKind",
  "pointMap",
  "width",
  "height",
  "camera",
  "cameraFile",
  "imageId",
  "mask",
  "resizeMask",
  "image",
];

/** The remedy for misspelt properties. */
export const spelling = "Check the spelling. Options belong in the second argument.";

const properties = [...frameProperties, "mesh"];

/**
 * Resolves an input. Readers are loaded only if a file needs them.
 * @param meshId the id of a prepared mesh
 * @throws {@link Sim3AlignError} for arguments of the wrong type, and the errors of the file readers
 */
export async function resolveInput(input: unknown, readers: FileReaders, meshId?: number): Promise<ResolvedInput> {
  checkProperties(input);
  const { resizeMask } = input;
  const { view, notes } = await readFrame(input, readers);
  const mask = await readMask(input.mask, Number(view.width) * Number(view.height), readers.formats);
  const mesh = await readCoreMesh(input.mesh, readers, view.image !== undefined, meshId);
  // Colours matter only where there is a photo to compare them with.
  const colors = view.image === undefined ? [] : mesh.warnings;
  const core = {
    ...view,
    resizeMask,
    mask: mask.data,
    maskWidth: mask.width,
    maskHeight: mask.height,
    mesh: mesh.mesh,
  };
  return { core: withoutUndefined(core) as CoreInput, notes: { ...notes, colors } };
}

/** A depth map or a point map, its photo and its camera, for the core; and what their files say. */
export interface ReadFrame {
  view: CoreView;
  notes: InputNotes;
}

/**
 * The depth map, or the point map, the photo and the camera of an input.
 * @throws {@link Sim3AlignError} as {@link resolveInput}
 */
export async function readView(input: unknown, readers: FileReaders): Promise<ReadFrame> {
  checkProperties(input);
  return readFrame(input, readers);
}

/** Like {@link readView}, for an input whose property names have been checked. */
export async function readFrame(input: Record<string, unknown>, readers: FileReaders): Promise<ReadFrame> {
  checkSides("", input);
  const { pointMap } = input;
  return pointMap === undefined ? depthFrame(input, readers) : pointMapFrame(input, pointMap, readers);
}

async function depthFrame(input: Record<string, unknown>, readers: FileReaders): Promise<ReadFrame> {
  const size = { width: input.width as number | undefined, height: input.height as number | undefined };
  const depthScale = input.depthScale as number | undefined;
  const depthKind = oneOf("depthKind", input.depthKind ?? "metric", depthKinds, "INVALID_ARGUMENT");
  const camera = await cameraOf(input);
  const { integerDepthScale } = camera;
  const reading = { depthScale, integerDepthScale, depthKind };
  const { data, unit, camera: inDepth, ...sides } = await readDepth(input.depth, size, reading, readers);
  const isFile = data !== input.depth && !isRecord(input.depth);
  const isFloat = isTypedArray(data, "Float32Array");
  // Integers of an unknown unit are read as they are.
  const integerScale = depthKind === "metric" ? integerDepthScale : 1;
  const image = await readPhoto(input.image, sides, readers.formats);
  const exif = camera.isGiven ? undefined : await readPhotoExif(input.image, readers.formats);
  const hints = { inDepth, photo: exif && image && { exif, size: image } };
  const read = {
    depth: data,
    // The readers have already scaled the values of a file.
    depthScale: isFile ? undefined : (depthScale ?? (isFloat ? undefined : integerScale)),
    depthKind: depthKind === "metric" ? undefined : depthKind,
  };
  return frameOf(read, sides, image, camera.resolve(sides.width, sides.height, hints), unit);
}

async function pointMapFrame(
  input: Record<string, unknown>,
  pointMap: unknown,
  readers: FileReaders,
): Promise<ReadFrame> {
  const other = ["depth", "depthScale"].find((name) => input[name] !== undefined);
  if (other !== undefined) {
    const remedy = `Omit ${other}: the point map contains the depth, in metres.`;
    throw invalidArgument(other, input[other], "a point map or depth, but not both", remedy);
  }
  const kinds = depthKinds.filter((kind) => !isAffineInvariant(kind));
  const depthKind = oneOf("depthKind", input.depthKind ?? "metric", kinds, "INVALID_ARGUMENT");
  const { data, ...sides } = readPointMap(pointMap, input as { width?: number; height?: number });
  const image = await readPhoto(input.image, sides, readers.formats);
  const isMetric = depthKind === "metric";
  const read = { pointMap: data, depthKind: isMetric ? undefined : depthKind };
  const camera = await cameraOf(input);
  // Intrinsics that were not given are fitted to the point map.
  const resolved = camera.isGiven ? camera.resolve(sides.width, sides.height) : { camera: undefined, warnings: [] };
  return frameOf(read, sides, image, resolved, isMetric ? "metres (point map)" : `unknown (${depthKind})`);
}

function frameOf(
  depth: { [K in "depth" | "depthScale" | "depthKind" | "pointMap"]?: CoreInput[K] | undefined },
  { width, height }: Omit<SizedArray<unknown>, "data">,
  image: Photo | undefined,
  { camera, focalDeviation, source, warnings }: ResolvedCamera,
  depthUnit: string,
): ReadFrame {
  const view = withoutUndefined({ ...depth, width, height, image, camera, focalDeviation });
  const notes = { warnings, colors: [], depthUnit, ...withoutUndefined({ cameraSource: source }) };
  return { view: view as CoreView, notes };
}

/** Rejects misspelt properties, which would otherwise be ignored. */
function checkProperties(input: unknown): asserts input is Record<string, unknown> {
  if (!isRecord(input)) {
    throw invalidArgument("input", input, "{ depth, mask, mesh, camera }", "See AlignInput in the documentation.");
  }
  checkNames("input.", input, properties, spelling);
}
