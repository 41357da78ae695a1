/** Depth maps with their cameras, as far as both are known. */
import type { DepthKind } from "sim3align";
import { depthOfRays } from "sim3align/camera/pinhole";
import type { DepthImage, ReadDepthOptions } from "sim3align/formats";
import { corrected, provisional } from "../state/calibration.js";
import type { NamedFile } from "../state/inputs.js";
import type { RawView, Scene } from "../state/scene.js";
import { readDepth } from "./reader.js";

/** A depth map that has been read. */
export interface ReadDepthMap extends DepthImage {
  depthKind: DepthKind;
}

/** What the values of a depth file probably are: 256 grey levels hold no distances, but what a relative model has drawn. */
function suggestedKind({ path }: Pick<NamedFile, "path">, bytes: Uint8Array): DepthKind {
  const isGrey8 = bytes[1] === 0x50 && bytes[2] === 0x4e && (bytes[24] ?? 16) <= 8 && bytes[25] === 0;
  return isGrey8 || /disp(arity)?([^a-z]|$)/i.test(path) ? "affine-invariant-disparity" : "metric";
}

/** Reads a depth file as what it is said or seems to be. */
export async function readDepthMap(
  file: NamedFile,
  kind: DepthKind | null,
  scales: Omit<ReadDepthOptions, "depthKind">,
): Promise<ReadDepthMap> {
  const bytes = await file.bytes();
  const depthKind = kind ?? suggestedKind(file, bytes);
  const { depthScale = 1 } = scales;
  if (depthScale < 0) {
    // In the frame of OpenGL, z points backwards. As values without a unit, they are read as they are.
    const read = await readDepth(bytes, { depthKind: "affine-invariant" });
    const data = read.data.map((z) => (Number.isFinite(z) ? z * depthScale : 0));
    return { ...read, data, unit: { metres: -depthScale, source: "entered", isAssumed: false }, depthKind: "metric" };
  }
  return { ...(await readDepth(bytes, { ...scales, depthKind })), depthKind };
}

/** A camera, and where it comes from if it was not given. */
export interface ReadCamera {
  camera: Scene["camera"];
  source: string | null;
  focalUncertainty: number;
  warnings: readonly string[];
}

/** The depth map as it is shown until it is calibrated, and what there is to calibrate. */
export function viewOf(
  { data, width, height, depthKind: kind }: Pick<ReadDepthMap, "data" | "width" | "height" | "depthKind">,
  read: ReadCamera | null,
): { depthM: Float32Array; raw: RawView | null } {
  const isAlongRays = kind === "ray-distance";
  const depth = isAlongRays && read?.camera ? depthOfRays(data, width, read.camera) : data;
  const depthKind = isAlongRays ? "metric" : kind;
  const depthM = corrected({ depth, width, height, depthKind }, provisional(depth, depthKind));
  if (read === null || (depthKind === "metric" && read.focalUncertainty === 0)) return { depthM, raw: null };
  const { camera, focalUncertainty, warnings } = read;
  return { depthM, raw: { depth, width, height, depthKind, camera, focalUncertainty, warnings } };
}
