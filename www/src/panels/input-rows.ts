/** What the depth map and the camera of a scene were taken to be, in plain words. */
import { depthKinds, unitText } from "sim3align/input/depth-kinds";
import type { Scene } from "../state/scene.js";
import { percent, significant } from "../ui/texts.js";

/** Where a camera comes from that was not given. */
export const cameraTitle = (source: string): string =>
  source === "estimate"
    ? "Estimated together with the poses"
    : source === "depth file"
      ? "From the depth file"
      : source;

/** The rows of the depth map and the camera. */
export function inputRows({
  camera,
  cameraSource,
  calibration,
  depthUnit,
  raw,
}: Scene): [title: string, text: string][] {
  const kind = raw?.depthKind ?? "metric";
  const { isMetric = kind === "metric", shift = 0, uncertainty = { shift: 0, focal: 0 } } = calibration ?? {};
  const within = (deviation: number) => (deviation > 0 ? ` ± ${percent(deviation)}` : "");
  const shifted = kind.startsWith("affine") && calibration !== null;
  const unit = isMetric ? "in metres by a known size" : "no unit: sizes are relative to one another";
  const depth = [
    ...(kind === "metric" ? [`Unit: ${unitText(depthUnit)}`] : [depthKinds[kind].title, unit]),
    ...(shifted
      ? [`shift ${significant(shift, 3)}; the distance is known to${within(uncertainty.shift) || " ± 0 %"}`]
      : []),
  ];
  const focal = `Focal length ${Math.round(camera.fx)} px${within(calibration === null ? (raw?.focalUncertainty ?? 0) : uncertainty.focal)}`;
  const source = cameraSource === null ? [] : [cameraTitle(cameraSource)];
  return [
    ["Depth", depth.join("; ")],
    ["Camera", [focal, ...source].join("; ")],
  ];
}
