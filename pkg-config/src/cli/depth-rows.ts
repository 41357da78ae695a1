/** How depth and camera were read, for people. */
import type { DepthCalibration, InputInfo } from "../index.js";
import { fixed, type Row, significant } from "./table.js";

/** The unit of the depth, its calibration, and where the camera comes from. */
export function depthRows({ depthUnit, cameraSource, depthCalibration }: InputInfo): Row[] {
  return [
    ...(depthUnit === undefined ? [] : [["depth unit", depthUnit] as const]),
    ...(depthCalibration === undefined
      ? []
      : [
          ["depth", depthText(depthCalibration)] as const,
          ["focal length", focalText(depthCalibration, cameraSource)] as const,
        ]),
    ...(depthCalibration === undefined && cameraSource !== undefined ? [["camera", cameraSource] as const] : []),
  ];
}

function depthText({ depthKind, scale, shift, uncertainty }: DepthCalibration): string {
  const s = significant(scale, 4);
  const shifted = `(d ${shift < 0 ? "−" : "+"} ${significant(Math.abs(shift), 4)})`;
  const z = {
    metric: "d",
    "scale-invariant": `${s}·d`,
    "affine-invariant": `${s}·${shifted}`,
    "affine-invariant-disparity": `${s} / ${shifted}`,
  }[depthKind];
  const sd = uncertainty.shift === 0 ? "" : `, ± ${fixed(100 * uncertainty.shift, 1)} % of the distance`;
  return `${depthKind}, z = ${z}${sd}`;
}

function focalText({ camera, isFocalEstimated, uncertainty }: DepthCalibration, source = "given"): string {
  const { fx, fy } = camera;
  const pixels = fx === fy ? `${fixed(fx, 1)} px` : `${fixed(fx, 1)} × ${fixed(fy, 1)} px`;
  return isFocalEstimated ? `${pixels} ± ${fixed(100 * uncertainty.focal, 1)} %, ${source}` : `${pixels}, ${source}`;
}
