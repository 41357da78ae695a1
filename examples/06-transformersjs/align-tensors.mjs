import { fromTensor, resizeInput } from "sim3align/conventions";

/**
 * Aligns a mesh with the tensors that transformers.js returns for one photo. No camera is needed: the photo's EXIF data state
 * the focal length, or it is estimated.
 *
 * @typedef {{ data: unknown, dims: readonly number[] }} Tensor such as a `Tensor` of transformers.js
 * @param {import("sim3align").Aligner} aligner
 * @param {object} found
 * @param {Tensor} found.predicted_depth from the pipeline `depth-estimation`: height × width floats. Do not use its
 * `depth`, which is an image with 256 levels
 * @param {import("sim3align").DepthKind} found.depthKind what the depth model returns
 * @param {Tensor} found.masks of one image, from `post_process_masks` of SAM: 1 × 3 × height × width, bool
 * @param {Tensor} found.iou_scores from SAM: 1 × 1 × 3
 * @param {Blob | Uint8Array | undefined} photo the file, of any size; with a coloured mesh, it also tells which side faces the
 * camera
 * @param {import("sim3align").MeshInput} mesh
 * @param {import("sim3align").AlignOptions} [options] `knownExtentM` makes relative depth metric
 */
export async function alignTensors(aligner, { predicted_depth, depthKind, masks, iou_scores }, photo, mesh, options) {
  const depth = fromTensor(predicted_depth, "depth");
  const mask = fromTensor(masks, "mask", { scores: iou_scores });
  // The pipelines resize depth and masks to the size of the image; a model that is called directly may not.
  const resized = resizeInput({ mask }, depth);
  return aligner.align({ depth, depthKind, ...resized, image: photo, mesh }, options);
}
