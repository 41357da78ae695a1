/** Longest side of the images that the models see, pixels; the photo keeps its size. */
const LONGEST = 1024;

/**
 * Loads a depth model and SAM. They are downloaded once, and cached by transformers.js.
 *
 * @param transformers the module `@huggingface/transformers`
 * @param names the models, what the values of the depth model are, and the device, such as `"webgpu"`
 * @returns a function that finds depth and mask of the object at a place of a photo: shares of its width and height
 */
export async function loadModels(
  { AutoProcessor, RawImage, SamModel, pipeline },
  {
    depth = "onnx-community/depth-anything-v2-small",
    depthKind = "affine-invariant-disparity",
    mask = "Xenova/slimsam-77-uniform",
    device = undefined,
  } = {},
) {
  const [estimator, sam, processor] = await Promise.all([
    pipeline("depth-estimation", depth, { device }),
    SamModel.from_pretrained(mask, { device }),
    AutoProcessor.from_pretrained(mask),
  ]);
  return async (/** @type {Blob} */ photo, [right, down]) => {
    const original = await RawImage.fromBlob(photo);
    const scale = Math.min(1, LONGEST / Math.max(original.width, original.height));
    const [width, height] = [original.width, original.height].map((side) => Math.round(scale * side));
    const picture = await original.resize(width, height);
    const { predicted_depth } = await estimator(picture);
    const inputs = await processor(picture, { input_points: [[[right * width, down * height]]] });
    const { pred_masks, iou_scores } = await sam(inputs);
    const [masks] = await processor.post_process_masks(pred_masks, inputs.original_sizes, inputs.reshaped_input_sizes);
    return { predicted_depth, depthKind, masks, iou_scores };
  };
}
