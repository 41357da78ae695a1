/** The camera of an input: intrinsics or a camera file. */

import type { StatedUnit } from "../camera/depth-unit.js";
import { imageCamera } from "../camera/image-camera.js";
import { type Pinhole, pinholeOf } from "../camera/pinhole.js";
import type { Warning } from "../generated/types.js";
import type { DepthImage } from "../types/inputs.js";
import { invalidArgument } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import type { ImageSize } from "../values/pixels.js";
import { stringsIn } from "../values/validation.js";
import { fileBytes } from "./bytes.js";
import { checkSides } from "./depth.js";
import { type CameraHints, foundCamera } from "./lens.js";

/** A parsed camera, whose intrinsics may depend on the image size. */
export interface Camera {
  /** The unit of integer depth, if the camera states it. */
  unit: StatedUnit | undefined;
  /** Whether the intrinsics were given. */
  isGiven: boolean;
  /** The intrinsics for an image of this size; `hints` where they were not given. */
  resolve(width: number | undefined, height: number | undefined, hints?: CameraHints): ResolvedCamera;
}

/** The intrinsics of a view. */
export interface ResolvedCamera {
  /** `undefined` if the image size is invalid, which the core reports before it reads the camera. */
  camera: Pinhole | undefined;
  /** Standard deviation of the logarithm of the focal length, if it is a guess. */
  focalDeviation?: number | undefined;
  /** The source of the intrinsics, if they were not given. */
  source?: string;
  warnings: readonly Warning[];
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
}

const warningsOf = (code: Warning["code"], messages: readonly string[]): Warning[] =>
  messages.map((message) => ({ code, message }));

const forms = "{ fx, fy, cx, cy }, { K } or { fovYDeg }";
const fileRemedy = "Pass the content of a camera file as cameraFile.";

/** `readCamera` adds others to the intrinsics of a camera file. */
const cameraProperties = [
  ...["fx", "fy", "cx", "cy", "K", "fovYDeg", "width", "height", "focalUncertainty"],
  ...["depthScale", "warnings", "doubts", "unread"],
];

/** The properties that state intrinsics. */
export const intrinsics: readonly string[] = ["fx", "fy", "cx", "cy", "K", "fovYDeg"];

/** The camera of an input, which has `camera`, `cameraFile`, or neither. */
export async function cameraOf({ camera, cameraFile, imageId }: Record<string, unknown>): Promise<Camera> {
  if (cameraFile === undefined) {
    const idRemedy = "It names one of several cameras of a file.";
    if (imageId !== undefined) throw invalidArgument("imageId", imageId, "nothing without a camera file", idRemedy);
    return statedCamera(camera === undefined ? {} : camera);
  }
  if (camera === undefined) return fileCamera(cameraFile, imageId);
  const remedy = "Omit one of the two.";
  throw invalidArgument("cameraFile", cameraFile, "a camera or a camera file, but not both", remedy);
}

function statedCamera(camera: unknown): Camera {
  if (!isRecord(camera)) throw invalidArgument("camera", camera, forms, fileRemedy);
  const other = Object.keys(camera).find((name) => !cameraProperties.includes(name));
  if (other !== undefined) {
    const remedy = `Rename or omit \`${other}\`; lengths are in pixels. ${fileRemedy}`;
    throw invalidArgument("camera", camera, forms, remedy);
  }
  const { width, height, depthScale, warnings, doubts, unread } = camera as Partial<ImageSize> &
    Record<string, unknown>;
  checkSides("camera.", { width, height });
  const stated = focalUncertainty(camera.focalUncertainty);
  const isGiven = intrinsics.some((name) => camera[name] !== undefined);
  return {
    unit: depthScale === undefined ? undefined : { metres: depthScale as number, key: "depthScale" },
    isGiven,
    resolve(imageWidth, imageHeight, hints = {}) {
      const size = sizeOf(imageWidth, imageHeight);
      if (size === undefined) return { camera: undefined, warnings: [] };
      const own = sizeOf(width, height);
      const given = () => {
        const fitted = imageCamera("camera", pinholeOf("camera", camera, own ?? size), own, size);
        return resolved({ camera: fitted.camera, warnings, doubts: [...stringsIn(doubts), ...fitted.doubts], unread });
      };
      const found: ResolvedCamera = isGiven ? given() : foundCamera(size, hints);
      return stated === undefined ? found : { ...found, focalDeviation: stated || undefined };
    },
  };
}

/** A camera with what its reader says of it. */
const resolved = (of: { camera: Pinhole; warnings: unknown; doubts?: unknown; unread?: unknown }): ResolvedCamera => ({
  camera: of.camera,
  warnings: [
    ...warningsOf("CAMERA_NOT_PINHOLE", stringsIn(of.warnings)),
    ...warningsOf("CAMERA_DOUBTFUL", stringsIn(of.doubts)),
  ],
  unread: stringsIn(of.unread),
});

/** A unit of depth with the key of the camera file that states it, and the doubt of its meaning. */
export function unitOf(unit: DepthImage["unit"], { unit: stated }: Camera) {
  if (unit.source !== "camera file" || stated === undefined) return { unit, warnings: [] };
  const warnings = warningsOf("CAMERA_DOUBTFUL", stated.doubt === undefined ? [] : [stated.doubt]);
  return { unit: { ...unit, source: `camera file: ${stated.key}` }, warnings };
}

/** The relative standard deviation of a focal length; 0 for one that is known. */
function focalUncertainty(value: unknown): number | undefined {
  if (value === undefined || (typeof value === "number" && value >= 0 && value < 1)) return value;
  const remedy = "Pass the relative standard deviation of the focal length: 0.1 for 10 %.";
  throw invalidArgument("camera.focalUncertainty", value, "a number from 0 to 1", remedy);
}

async function fileCamera(file: unknown, imageId: unknown): Promise<Camera> {
  const content =
    isRecord(file) || Array.isArray(file) || typeof file === "string" ? file : await fileBytes("cameraFile", file);
  if (content === null) {
    const expected = "the bytes, the text or the parsed JSON of a camera file";
    throw invalidArgument("cameraFile", file, expected, "Pass intrinsics such as { fx, fy, cx, cy } as camera.");
  }
  // Most calls pass intrinsics.
  const { openCameraFile } = await import("../camera/camera-file.js");
  const opened = await openCameraFile(content, imageId, { file: "cameraFile", options: "" });
  return {
    unit: opened.unit,
    isGiven: true,
    resolve(width, height) {
      const size = sizeOf(width, height);
      if (size === undefined) return { camera: undefined, warnings: [] };
      const { fx, fy, cx, cy, focalUncertainty: uncertainty, ...notes } = opened.of(size);
      const focalDeviation = focalUncertainty(uncertainty) || undefined;
      return { ...resolved({ camera: { fx, fy, cx, cy }, ...notes }), ...(focalDeviation && { focalDeviation }) };
    },
  };
}

/** The image size, if it is valid. */
const sizeOf = (width: unknown, height: unknown): ImageSize | undefined =>
  [width, height].every((side) => Number.isSafeInteger(side) && (side as number) > 0)
    ? { width: width as number, height: height as number }
    : undefined;
