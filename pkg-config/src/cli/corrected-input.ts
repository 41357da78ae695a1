/** Inputs with the depth and the camera of a calibration. */
import { correctDepth } from "../conventions/corrected-depth.js";
import { fileReaders } from "../file-readers.js";
import type { AlignInput, DepthCalibration } from "../index.js";
import { readView } from "../input/resolve.js";

/** An input in the lengths of a result. Results without a calibration leave the depth as it is. */
export async function correctedInput(
  input: AlignInput,
  calibration: DepthCalibration | undefined,
): Promise<AlignInput> {
  if (calibration === undefined) return input;
  const { image, mask, mesh, resizeMask } = input;
  // The photo is not needed to read the depth.
  const { view } = await readView({ ...input, image: undefined }, fileReaders);
  const seen = { data: view.depth as Float32Array, width: Number(view.width), height: Number(view.height) };
  const depth = correctDepth(seen, calibration);
  return { depth, camera: calibration.camera, mask, mesh, image, resizeMask };
}
