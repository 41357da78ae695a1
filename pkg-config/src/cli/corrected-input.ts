/** Inputs in the depth and with the camera that their results found. */
import { correctDepth } from "../conventions/depth.js";
import { fileReaders } from "../file-readers.js";
import type { AlignInput, DepthCalibration } from "../index.js";
import { readView } from "../input/resolve.js";

/** An input whose lengths are those of a result. Without a calibration, the depth was known. */
export async function correctedInput(
  input: AlignInput,
  calibration: DepthCalibration | undefined,
): Promise<AlignInput> {
  if (calibration === undefined) return input;
  const { image, mask, mesh, resizeMask } = input;
  // The photo says nothing more about the depth.
  const { view } = await readView({ ...input, image: undefined }, fileReaders);
  const seen = { data: view.depth as Float32Array, width: Number(view.width), height: Number(view.height) };
  const depth = correctDepth(seen, calibration);
  return { depth, camera: calibration.camera, mask, mesh, image, resizeMask };
}
