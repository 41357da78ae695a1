/** Converts inputs to the typed arrays and numbers of the core. */

import { invalidArgument } from "../error.js";
import type { FileReaders } from "../file-readers.js";
import type { FileWarnings } from "../results.js";
import type { ClassNames } from "../snapshot.js";
import { checkNames, isRecord, isTypedArray, withoutUndefined } from "../values.js";
import { cameraOf, cameraProperties } from "./camera.js";
import type { CoreInput } from "./core-input.js";
import { checkSides, readDepth, readPointMap } from "./depth.js";
import { readMask } from "./mask.js";
import { readCoreMesh } from "./mesh.js";
import { readPhoto } from "./photo.js";

/** A resolved input, and the warnings of its files. */
export interface ResolvedInput {
  core: CoreInput;
  warnings: FileWarnings;
}

/** The properties of a frame: those of an input but the mesh. */
export const frameProperties: readonly string[] = [
  "depth",
  "depthScale",
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

/** The accessors of an ImageData. */
const pixelNames = ["data", "width", "height"];

/** The properties that an input and its parts may inherit from a class; others of the class are not arguments. */
export const classNames: ClassNames = {
  input: properties,
  "input.camera": cameraProperties,
  "input.image": pixelNames,
  "input.views[].camera": cameraProperties,
  "input.views[].image": pixelNames,
};

/**
 * Resolves an input. Readers are loaded only if a file needs them.
 * @param meshId the id of a prepared mesh
 * @throws {@link Sim3AlignError} for arguments of the wrong type, and the errors of the file readers
 */
export async function resolveInput(input: unknown, readers: FileReaders, meshId?: number): Promise<ResolvedInput> {
  checkProperties(input);
  const { resizeMask } = input;
  const { warnings, ...view } = await imageAndCamera(input, readers);
  const mask = await readMask(input.mask, Number(view.width) * Number(view.height), readers.formats);
  const image = await readPhoto(input.image, view, readers.formats);
  const mesh = await readCoreMesh(input.mesh, readers.formats, image !== undefined, meshId);
  // Colours matter only where there is a photo to compare them with.
  const colorWarnings = image === undefined ? [] : mesh.warnings;
  const core = {
    ...view,
    image,
    resizeMask,
    mask: mask.data,
    maskWidth: mask.width,
    maskHeight: mask.height,
    mesh: mesh.mesh,
  };
  return { core: withoutUndefined(core) as CoreInput, warnings: { camera: warnings, colors: colorWarnings } };
}

/**
 * The depth map, or the point map, and the camera of an input.
 * @throws {@link Sim3AlignError} as {@link resolveInput}
 */
export async function readView(input: unknown, readers: FileReaders) {
  checkProperties(input);
  return imageAndCamera(input, readers);
}

/** Like {@link readView}, for an input whose property names have been checked. */
export async function imageAndCamera(input: Record<string, unknown>, readers: FileReaders) {
  checkSides("", input);
  const { pointMap } = input;
  return pointMap === undefined ? depthAndCamera(input, readers) : pointMapAndCamera(input, pointMap);
}

async function depthAndCamera(input: Record<string, unknown>, readers: FileReaders) {
  const size = { width: input.width as number | undefined, height: input.height as number | undefined };
  const depthScale = input.depthScale as number | undefined;
  const camera = await cameraOf(input);
  const { integerDepthScale } = camera;
  const { data, width, height } = await readDepth(input.depth, size, { depthScale, integerDepthScale }, readers);
  const isFile = data !== input.depth && !isRecord(input.depth);
  const isFloat = isTypedArray(data, "Float32Array");
  return {
    depth: data,
    // The readers have already scaled the values of a file.
    depthScale: isFile ? undefined : (depthScale ?? (isFloat ? undefined : integerDepthScale)),
    width,
    height,
    ...camera.resolve(width, height),
  };
}

async function pointMapAndCamera(input: Record<string, unknown>, pointMap: unknown) {
  const other = ["depth", "depthScale"].find((name) => input[name] !== undefined);
  if (other !== undefined) {
    const remedy = `Omit ${other}: the point map contains the depth, in metres.`;
    throw invalidArgument(other, input[other], "a point map or depth, but not both", remedy);
  }
  const { data, width, height } = readPointMap(pointMap, input as { width?: number; height?: number });
  const image = { pointMap: data, depthScale: undefined, width, height };
  if (input.camera === undefined && input.cameraFile === undefined)
    return { ...image, camera: undefined, warnings: [] };
  const camera = await cameraOf(input);
  return { ...image, ...camera.resolve(width, height) };
}

/** Rejects misspelt properties, which would otherwise be ignored. */
function checkProperties(input: unknown): asserts input is Record<string, unknown> {
  if (!isRecord(input)) {
    throw invalidArgument("input", input, "{ depth, mask, mesh, camera }", "See AlignInput in the documentation.");
  }
  checkNames("input.", input, properties, spelling);
}
