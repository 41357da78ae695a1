import { depthFromDisparity, depthFromTensor, maskFromTensor, resizeMask } from "sim3align/conventions";

/**
 * Aligns a mesh with the tensors that transformers.js returns for one image.
 *
 * @typedef {import("sim3align/conventions").TensorLike} Tensor such as a `Tensor` of transformers.js
 * @param {import("sim3align").Aligner} aligner
 * @param {object} found
 * @param {Tensor} found.predicted_depth from the pipeline `depth-estimation`: height × width floats. Do not use its
 * `depth`, which is an image with 256 levels
 * @param {Tensor} found.masks of one image, from `post_process_masks` of SAM: 1 × 3 × height × width, bool
 * @param {Tensor} found.iou_scores from SAM: 1 × 1 × 3
 * @param {{ scale: number, shift: number } | undefined} found.disparity converts the inverse depth of relative models
 * (Depth Anything, MiDaS) to metres; fit it to a few known distances. Omit it for metric models
 * @param {{ data: Uint8Array | Uint8ClampedArray, width: number, height: number } | undefined} found.image the photo, RGB or
 * RGBA, such as a `RawImage` of transformers.js: with a coloured mesh, it tells which side faces the camera
 * @param {{ fovYDeg: number } | { fx: number, fy: number, cx: number, cy: number }} camera intrinsics in pixels of the image
 * @param {import("sim3align").MeshInput} mesh
 */
export async function alignTensors(aligner, { predicted_depth, masks, iou_scores, disparity, image }, camera, mesh) {
  const values = depthFromTensor(predicted_depth);
  const depth = disparity === undefined ? values : depthFromDisparity(values, disparity);
  const mask = maskFromTensor(masks, { scores: iou_scores });
  // The pipelines resize depth and masks to the size of the image; a model that is called directly may not.
  return aligner.align({ depth, mask: resizeMask(mask, depth), camera, mesh, image });
}
