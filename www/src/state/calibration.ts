/** Views whose depth or focal length are not fully known: what they are taken to be, before and after an alignment. */
import type { DepthCalibration, DepthKind } from "sim3align";
import { correctDepth } from "sim3align/conventions/depth";
import type { RawView, Scene } from "./scene.js";

type Numbers = Pick<DepthCalibration, "depthKind" | "scale" | "shift">;

/** The nearest depth that is shown before an alignment, as a share of the depths' range, or the inverse for disparity. */
const NEAREST = 0.3;

/** Numbers that show the relief of a depth map until an alignment has found those of the objects. */
export function provisional(values: Float32Array, depthKind: DepthKind): Numbers {
  if (depthKind === "scale-invariant") return { depthKind, scale: 1, shift: 0 };
  if (depthKind === "metric" || depthKind === "ray-distance") return { depthKind: "metric", scale: 1, shift: 0 };
  const step = 2 * Math.floor(values.length / 40_000) + 1;
  const sorted = values.filter((d, i) => i % step === 0 && Number.isFinite(d)).sort();
  const at = (share: number) => sorted[Math.floor(share * (sorted.length - 1))] ?? 0;
  const range = at(0.99) - at(0.01) || 1;
  const shift = NEAREST * range - at(0.01);
  return { depthKind, scale: depthKind === "affine-invariant" ? 1 / range : range, shift };
}

/** The depth map of a raw view with these numbers. */
export function corrected(
  { depth, width, height, depthKind }: Pick<RawView, "depth" | "width" | "height" | "depthKind">,
  numbers: Numbers,
): Float32Array {
  if (depthKind === "metric") return depth;
  return correctDepth({ data: depth, width, height }, numbers as DepthCalibration).data;
}

/** A scene in the depth and with the camera of a calibration. */
export function inCalibration(scene: Scene, calibration: DepthCalibration, more: readonly string[] = []): Scene {
  const { raw } = scene;
  if (raw === null) return scene;
  const warnings = [...new Set([...raw.warnings, ...more])];
  return { ...scene, depthM: corrected(raw, calibration), camera: calibration.camera, calibration, warnings };
}
