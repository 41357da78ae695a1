import { depthFromDisparity, depthFromTensor, maskFromTensor, resizeMask } from "sim3align/conventions";

/**
 * Aligns a mesh to what transformers.js returns for one image.
 *
 * @typedef {import("sim3align/conventions").TensorLike} Tensor a transformers.js `Tensor` is one
 * @param {import("sim3align").Aligner} aligner
 * @param {object} found
 * @param {Tensor} found.predicted_depth of the pipeline `depth-estimation`: height × width, floats; not its `depth`,
 * which is a picture of 256 steps
 * @param {Tensor} found.masks one image's, of SAM's `post_process_masks`: 1 × 3 × height × width, bool
 * @param {Tensor} found.iou_scores of SAM: 1 × 1 × 3
 * @param {{ scale: number, shift: number } | undefined} found.disparity for relative models (Depth Anything, MiDaS), whose
 * values are larger where it is nearer: what makes metres of them, fitted to a few known distances. Leave it out for
 * metric models
 * @param {{ fovYDeg: number } | { fx: number, fy: number, cx: number, cy: number }} camera of the image, in its pixels
 * @param {import("sim3align").MeshInput} mesh
 */
export async function alignTensors(aligner, { predicted_depth, masks, iou_scores, disparity }, camera, mesh) {
  const values = depthFromTensor(predicted_depth);
  const depth = disparity === undefined ? values : depthFromDisparity(values, disparity);
  const mask = maskFromTensor(masks, { scores: iou_scores });
  // The pipeline brings its depth to the image's size, as SAM its masks; models called by hand may not.
  return aligner.align({ depth, mask: resizeMask(mask, depth), camera, mesh });
}
