import { readDepth, readMask } from "sim3align/formats";

/** A tensor of transformers.js. */
const tensor = (data, ...dims) => ({ data, dims });

/**
 * Stands in for `loadModels` where there is no network: the tensors that perfect models would return for a photo of the
 * sample, made of its depth map and mask.
 * @param {(name: string) => Promise<Uint8Array | Blob>} file reads a file of the sample
 */
export async function loadSampleModels(file) {
  const [{ data, width, height }, mask] = await Promise.all([
    file("depth.npy").then((bytes) => readDepth(bytes)),
    file("mask.png").then((bytes) => readMask(bytes)),
  ]);
  // Relative models return inverse depth of an unknown scale and shift, and know no pixel without depth.
  const disparity = data.map((z) => (z > 0 ? (1 / z - 0.2) / 3 : 0));
  // SAM returns three masks: here a part of the object, the object, and everything.
  const isObject = mask.data.map((value) => (value === 0 ? 0 : 1));
  const part = isObject.map((value, i) => (i % width < 0.5 * width ? value : 0));
  const three = Uint8Array.from([...part, ...isObject, ...new Uint8Array(isObject.length).fill(1)]);
  return async () => ({
    predicted_depth: tensor(disparity, height, width),
    depthKind: /** @type {const} */ ("affine-invariant-disparity"),
    masks: tensor(three, 1, 3, height, width),
    iou_scores: tensor(Float32Array.of(0.88, 0.98, 0.93), 1, 1, 3),
  });
}
