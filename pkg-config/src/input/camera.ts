/** Cameras: intrinsics as they are, or a camera file. */

import type { Formats } from "../core.js";
import { invalidArgument, Sim3AlignError } from "../error.js";
import { isRecord, plainNumbers, withoutOptions, withoutUndefined } from "../values.js";
import type { LoadedModule } from "../wasm-module.js";
import { fileBytes } from "./bytes.js";

/** The core's forms of a camera. */
export type CoreCamera = { fx: unknown; fy: unknown; cx: unknown; cy: unknown } | { K: unknown } | { fovYDeg: unknown };

const directKeys = new Set(["fx", "fy", "cx", "cy", "K", "fovYDeg", "width", "height"]);

const kinds =
  "{ fx, fy, cx, cy }, { K }, { fovYDeg }, or the content of a camera file (camera.json, BOP scene_camera.json, ROS CameraInfo)";

/** A camera whose kind is known; the image's size may not be yet. */
export interface Camera {
  /** Metres per unit of whole-number depth, where a file says so. */
  integerDepthScale: number | undefined;
  /** The intrinsics for an image of this size, where it is known. */
  resolve(width: number | undefined, height: number | undefined): { camera: CoreCamera; warnings: string[] };
}

/** Finds out what kind of camera this is, and reads its file. */
export async function readCamera(
  camera: unknown,
  imageId: unknown,
  formats: () => Promise<LoadedModule<Formats>>,
): Promise<Camera> {
  if (isRecord(camera) && isDirect(camera)) {
    const resolve = (width: number | undefined, height: number | undefined) => {
      checkSize(camera, width, height);
      return { camera: intrinsics(camera), warnings: [] };
    };
    return { integerDepthScale: undefined, resolve };
  }
  const content = isRecord(camera) || typeof camera === "string" ? camera : await fileBytes(camera);
  if (content === null) throw invalidArgument("camera", camera, kinds, "Pass the camera that took the depth map.");
  const module = await formats();
  const read = (width?: number, height?: number) => {
    const options = withoutUndefined({ width, height, imageId: imageId as string | undefined });
    return module.call((readers) => readers.readCamera(content, options), withoutOptions);
  };
  return {
    integerDepthScale: depthScaleOf(read),
    resolve(width, height) {
      const { fx, fy, cx, cy, warnings } = read(width, height);
      return { camera: { fx, fy, cx, cy }, warnings };
    },
  };
}

/** Whether the core understands it as it is. */
const isDirect = (camera: Record<string, unknown>) =>
  Object.keys(camera).every((key) => directKeys.has(key)) && ("fx" in camera || "K" in camera || "fovYDeg" in camera);

function intrinsics(camera: Record<string, unknown>): CoreCamera {
  const { fx, fy, cx, cy, K, fovYDeg } = camera;
  if (K !== undefined) return { K: plainNumbers(K) };
  return fovYDeg === undefined ? { fx, fy, cx, cy } : { fovYDeg };
}

function checkSize(camera: Record<string, unknown>, width: number | undefined, height: number | undefined): void {
  // A size that is none is for the core to refuse.
  if (!Number.isInteger(width) || !Number.isInteger(height)) return;
  const { width: cameraWidth = width, height: cameraHeight = height } = camera;
  if (cameraWidth === width && cameraHeight === height) return;
  throw new Sim3AlignError({
    code: "SIZE_MISMATCH",
    argument: "camera",
    found: `intrinsics for ${cameraWidth} × ${cameraHeight} pixels beside an image of ${width} × ${height}`,
    expected: "intrinsics of this very image",
    remedy: "Scale fx, cx by the ratio of the widths and fy, cy by that of the heights, or pass the full-size depth.",
  });
}

/** The first reading is for the scale only; whatever is wrong with the file, the one with the size will say it. */
function depthScaleOf(read: () => { depthScale?: number }): number | undefined {
  try {
    return read().depthScale;
  } catch {
    return undefined;
  }
}
