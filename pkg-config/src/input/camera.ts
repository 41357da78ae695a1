/** The camera of an input: stated intrinsics, or a camera file. */
import { invalidArgument } from "../error.js";
import { checkCameraSize, depthScaleIn, parseCameraFile } from "../formats/camera-file.js";
import { type Pinhole, pinholeOf } from "../formats/pinhole.js";
import type { ImageSize } from "../formats/pixels.js";
import { isRecord } from "../values.js";
import { fileBytes } from "./bytes.js";

/** A camera that was read; its intrinsics may depend on the image's size. */
export interface Camera {
  /** Metres per unit of whole-number depth, where the camera file states it. */
  integerDepthScale: number | undefined;
  /** The intrinsics for an image of this size. */
  resolve(width: number | undefined, height: number | undefined): ResolvedCamera;
}

interface ResolvedCamera {
  /** `undefined` where the image has no valid size, which the core refuses before it looks at the camera. */
  camera: Pinhole | undefined;
  warnings: readonly string[];
}

const forms = "{ fx, fy, cx, cy }, { K } or { fovYDeg }";

/** `warnings` and `depthScale` are what `readCamera` adds to the intrinsics of a camera file. */
const properties = ["fx", "fy", "cx", "cy", "K", "fovYDeg", "width", "height", "warnings", "depthScale"];

/** The camera of an input, which has either `camera` or `cameraFile`. */
export async function cameraOf({ camera, cameraFile, imageId }: Record<string, unknown>): Promise<Camera> {
  if (cameraFile === undefined) return statedCamera(camera);
  if (camera === undefined) return fileCamera(cameraFile, imageId);
  const remedy = "Leave one of the two out.";
  throw invalidArgument("cameraFile", cameraFile, "a camera or a camera file, but not both", remedy);
}

function statedCamera(camera: unknown): Camera {
  const other = isRecord(camera) ? Object.keys(camera).find((name) => !properties.includes(name)) : undefined;
  if (!isRecord(camera) || other !== undefined) {
    throw invalidArgument("camera", camera, forms, "Pass the content of a camera file as cameraFile.");
  }
  const { width, height, depthScale, warnings } = camera as Partial<ImageSize> & Record<string, unknown>;
  return {
    integerDepthScale: depthScale as number | undefined,
    resolve(imageWidth, imageHeight) {
      const size = sizeOf(imageWidth, imageHeight);
      if (size === undefined) return { camera: undefined, warnings: [] };
      checkCameraSize("camera", { width, height }, size);
      return { camera: pinholeOf("camera", camera, size), warnings: (warnings ?? []) as string[] };
    },
  };
}

async function fileCamera(file: unknown, imageId: unknown): Promise<Camera> {
  const content = isRecord(file) || Array.isArray(file) || typeof file === "string" ? file : await fileBytes(file);
  if (content === null) {
    const expected = "the bytes, the text or the parsed JSON of a camera file";
    throw invalidArgument("cameraFile", file, expected, "Pass { fx, fy, cx, cy } and the like as camera.");
  }
  return {
    integerDepthScale: depthScaleIn(content, imageId as string | undefined),
    resolve(width, height) {
      const size = sizeOf(width, height);
      if (size === undefined) return { camera: undefined, warnings: [] };
      const options = { ...size, imageId: imageId as string | undefined };
      const { fx, fy, cx, cy, warnings } = parseCameraFile(content, options, { file: "cameraFile", options: "" });
      return { camera: { fx, fy, cx, cy }, warnings };
    },
  };
}

/** The image's size, where it is one. */
const sizeOf = (width: unknown, height: unknown): ImageSize | undefined =>
  [width, height].every((side) => Number.isSafeInteger(side) && (side as number) > 0)
    ? { width: width as number, height: height as number }
    : undefined;
