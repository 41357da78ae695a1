/** From what callers have to what the core takes: typed arrays and numbers. */

import type { Formats } from "../core.js";
import { invalidArgument, Sim3AlignError } from "../error.js";
import { isRecord, isTypedArray, withoutUndefined } from "../values.js";
import type { LoadedModule } from "../wasm-module.js";
import { type CoreCamera, readCamera } from "./camera.js";
import { readDepth, readPointMap } from "./depth.js";
import { readMask } from "./mask.js";
import { type CoreMesh, readMesh } from "./mesh.js";

/** The input as the core takes it; it checks lengths and values. */
export interface CoreInput {
  depth?: Float32Array | Uint16Array;
  depthScale?: unknown;
  pointMap?: Float32Array;
  width?: unknown;
  height?: unknown;
  mask: Uint8Array | Uint8ClampedArray;
  maskWidth?: number;
  maskHeight?: number;
  resizeMask?: unknown;
  camera?: CoreCamera;
  mesh: CoreMesh;
}

/** A resolved input, and what its files warn of. */
export interface ResolvedInput {
  core: CoreInput;
  warnings: string[];
}

const properties = [
  ...["depth", "depthScale", "pointMap", "width", "height", "camera", "imageId"],
  ...["mask", "resizeMask", "mesh"],
];

/**
 * Resolves an input. Files are decoded by `formats`, which is asked for only where there is one.
 * @throws {@link Sim3AlignError} for arguments of the wrong kind, and those of the file readers
 */
export async function resolveInput(
  input: unknown,
  formats: () => Promise<LoadedModule<Formats>>,
): Promise<ResolvedInput> {
  checkProperties(input);
  const { resizeMask, pointMap } = input;
  const { warnings, ...image } =
    pointMap === undefined ? await depthAndCamera(input, formats) : await pointMapAndCamera(input, pointMap, formats);
  const mask = await readMask(input.mask, Number(image.width) * Number(image.height), formats);
  const core = {
    ...image,
    resizeMask,
    mask: mask.data,
    maskWidth: mask.width,
    maskHeight: mask.height,
    mesh: await readMesh(input.mesh, formats),
  };
  return { core: withoutUndefined(core) as CoreInput, warnings };
}

async function depthAndCamera(input: Record<string, unknown>, formats: () => Promise<LoadedModule<Formats>>) {
  const size = { width: input.width as number | undefined, height: input.height as number | undefined };
  const depthScale = input.depthScale as number | undefined;
  const camera = await readCamera(input.camera, input.imageId, formats);
  const { integerDepthScale } = camera;
  const { data, width, height } = await readDepth(input.depth, size, { depthScale, integerDepthScale }, formats);
  const isFile = data !== input.depth && !isRecord(input.depth);
  const isFloat = isTypedArray(data, "Float32Array");
  return {
    depth: data,
    // The readers have applied the scale to a file's values already.
    depthScale: isFile ? undefined : (depthScale ?? (isFloat ? undefined : integerDepthScale)),
    width,
    height,
    ...camera.resolve(width, height),
  };
}

async function pointMapAndCamera(
  input: Record<string, unknown>,
  pointMap: unknown,
  formats: () => Promise<LoadedModule<Formats>>,
) {
  const other = ["depth", "depthScale"].find((name) => input[name] !== undefined);
  if (other !== undefined) {
    const remedy = `Leave ${other} out: the point map has the depth, in metres.`;
    throw invalidArgument(other, input[other], "a point map or depth, but not both", remedy);
  }
  const { data, width, height } = readPointMap(pointMap, input as { width?: number; height?: number });
  const image = { pointMap: data, depthScale: undefined, width, height };
  if (input.camera === undefined) return { ...image, camera: undefined, warnings: [] };
  const camera = await readCamera(input.camera, input.imageId, formats);
  return { ...image, ...camera.resolve(width, height) };
}

/** A misspelt property would go unnoticed, and its default be used. */
function checkProperties(input: unknown): asserts input is Record<string, unknown> {
  if (!isRecord(input)) {
    throw invalidArgument("input", input, "{ depth, mask, mesh, camera }", "See AlignInput in the documentation.");
  }
  const unknown = Object.keys(input).find((name) => !properties.includes(name));
  if (unknown === undefined) return;
  throw new Sim3AlignError({
    code: "INVALID_ARGUMENT",
    argument: `input.${unknown}`,
    found: "a property that does not exist",
    expected: properties.join(", "),
    remedy: "Check the spelling; options go into the second argument.",
  });
}
