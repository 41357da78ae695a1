/** three.js cameras that match a pinhole camera. */

import { pinholeOf } from "../camera/pinhole.js";
import type { CameraInput } from "../types/inputs.js";
import { plainArgument } from "../values/border.js";
import { failure } from "../values/error.js";
import { withForeignObject } from "../values/foreign-objects.js";
import { type ImageSize, sizeOf } from "../values/pixels.js";
import { positive, record } from "../values/validation.js";
import type { PerspectiveCameraLike } from "./types.js";

/** The image size, and the near and far planes. */
export interface LensOptions extends ImageSize {
  /** In metres, above 0; 0.01 by default. */
  near?: number | undefined;
  /** In metres, beyond `near`; 100 by default. */
  far?: number | undefined;
}

/** The settings of a three.js camera. */
export interface ThreeCamera {
  /** The vertical field of view of an image with a centred principal point, in degrees. */
  fov: number;
  /** Width / height, after scaling to square pixels. */
  aspect: number;
  near: number;
  far: number;
  /** The arguments of `camera.setViewOffset` that move the principal point. */
  view: { fullWidth: number; fullHeight: number; offsetX: number; offsetY: number; width: number; height: number };
  /** For WebGL: clip space from the OpenGL camera frame, z in [−1, 1], column-major. */
  projectionMatrix: Float64Array;
}

/**
 * The settings of a three.js camera that match a pinhole camera. The principal point may be anywhere, and pixels need not
 * be square. {@link applyPinhole} applies them to a `PerspectiveCamera`.
 *
 * The image spans −0.5 to width − 0.5, because pixel centres have integer coordinates.
 *
 * @param camera { fx, fy, cx, cy }, { K } or { fovYDeg }, in pixels
 * @param lens the image's `width` and `height`, and `near` and `far` in metres
 *
 * @example
 * const { fov, aspect, projectionMatrix } = cameraFromPinhole({ fx: 600, fy: 600, cx: 320, cy: 240 }, { width: 640, height: 480 });
 * @throws {@link Sim3AlignError} `INVALID_CAMERA`, or for sizes below one pixel
 */
export function cameraFromPinhole(camera: CameraInput, lens: LensOptions): ThreeCamera {
  const given = record("lens", lens, "{ width, height, near?, far? }");
  const { width, height } = sizeOf("lens", given);
  const near = positive("lens.near", given.near ?? 0.01);
  const far = positive("lens.far", given.far ?? 100);
  if (!(far > near)) {
    throw failure("INVALID_ARGUMENT", "lens.far", `${far}`, `a distance beyond near, ${near}`, "Swap them.");
  }
  const { fx, fy, cx, cy } = pinholeOf("camera", plainArgument("camera", camera), { width, height });
  const projectionMatrix = new Float64Array(16);
  projectionMatrix[0] = (2 * fx) / width;
  projectionMatrix[5] = (2 * fy) / height;
  // From the centre of the image to the principal point; v points down, y up.
  projectionMatrix[8] = 1 - (2 * cx + 1) / width;
  projectionMatrix[9] = (2 * cy + 1) / height - 1;
  projectionMatrix[10] = (far + near) / (near - far);
  projectionMatrix[11] = -1;
  projectionMatrix[14] = (2 * far * near) / (near - far);
  return {
    fov: (360 / Math.PI) * Math.atan(height / 2 / fy),
    aspect: (width * fy) / (height * fx),
    near,
    far,
    view: {
      ...{ fullWidth: width, fullHeight: height, width, height },
      ...{ offsetX: width / 2 - (cx + 0.5), offsetY: height / 2 - (cy + 0.5) },
    },
    projectionMatrix,
  };
}

/**
 * Makes a `PerspectiveCamera` match a pinhole camera: sets its field of view, aspect, near, far and view offset, which
 * `updateProjectionMatrix` keeps, for WebGL and WebGPU. Draw to a canvas with the aspect ratio of the image, and do not
 * set `aspect` when the canvas is resized.
 *
 * @param target the three.js camera; its pose is unchanged
 * @param camera as for {@link cameraFromPinhole}
 *
 * @example
 * applyPinhole(threeCamera, { fx: 600, fy: 600, cx: 310, cy: 250 }, { width: 640, height: 480 });
 * @throws {@link Sim3AlignError} as {@link cameraFromPinhole}
 */
export function applyPinhole(target: PerspectiveCameraLike, camera: CameraInput, lens: LensOptions): void {
  const { fov, aspect, near, far, view } = cameraFromPinhole(camera, lens);
  withForeignObject("target", "a PerspectiveCamera", () => {
    Object.assign(target, { fov, near, far, zoom: 1, filmOffset: 0 });
    target.setViewOffset(view.fullWidth, view.fullHeight, view.offsetX, view.offsetY, view.width, view.height);
    // setViewOffset has set the aspect for square pixels.
    target.aspect = aspect;
    target.updateProjectionMatrix();
  });
}
