/** Masks and depth maps from tensors of transformers.js. */

import { checkAttached } from "../values/border.js";
import { describe, failure } from "../values/error.js";
import { withForeignObject } from "../values/foreign-objects.js";
import { isKind, isRecord, isTypedArray, typedArrayKind } from "../values/kinds.js";
import { checkCount, type PixelArray } from "../values/pixels.js";
import { flattened, oneOf, record, whole, wrongKind } from "../values/validation.js";

/** A tensor of transformers.js, or any object with `data` and `dims`. */
export interface TensorLike {
  /** The values; the last dimension changes fastest. */
  readonly data: unknown;
  /** The dimensions, the last two being height and width. */
  readonly dims: readonly number[];
}

function dimensions(tensor: unknown) {
  const expected = "a tensor: { data, dims }";
  // Those of transformers.js do not have their properties themselves.
  const { data, dims: given } = withForeignObject("tensor", expected, () => {
    const { data, dims } = Object(tensor) as TensorLike;
    return record("tensor", typeof tensor === "object" && tensor !== null ? { data, dims } : tensor, expected);
  });
  const dims = flattened(given);
  if (dims === null || dims.length < 2) {
    const remedy = "Pass one tensor, not a list of them.";
    throw failure("INVALID_ARGUMENT", "tensor.dims", describe(given), "[…, height, width]", remedy);
  }
  const [height, width] = dims.slice(-2).map((dimension) => whole("tensor.dims", dimension, 1)) as [number, number];
  const count = dims.slice(0, -2).reduce((all: number, dimension) => all * whole("tensor.dims", dimension, 1), 1);
  if (typedArrayKind(data) === undefined && !isKind(data, "Array")) {
    throw wrongKind("tensor.data", data, "a typed array", "Float32Array");
  }
  // A list has numbers; what else is in it may have no end.
  if (ArrayBuffer.isView(data)) checkAttached("tensor.data", data);
  checkCount("tensor.data", (data as ArrayLike<unknown>).length, { width, height }, count);
  return { data, width, height, count };
}

/** Which of several masks: its index in the tensor, or the score of each, of which the highest wins. */
export interface MaskChoice {
  index?: number | undefined;
  scores?: TensorLike | ArrayLike<number> | undefined;
}

/**
 * Extracts a depth map from a tensor: `predicted_depth` of a depth model. With relative models, pass their `depthKind` to
 * `align`, or the result to `correctDepth`.
 *
 * @param tensor floats, height × width, or with leading dimensions of 1
 * @returns the unchanged values
 *
 * @example
 * const { predicted_depth } = await estimator(image);    // pipeline("depth-estimation", …)
 * const depth = fromTensor(predicted_depth, "depth");
 * @throws {@link Sim3AlignError} `EIGHT_BIT_DEPTH` for integers: the `depth` of transformers.js is a visualisation
 */
export function fromTensor(tensor: TensorLike, content: "depth"): PixelArray<Float32Array>;
/**
 * Extracts one mask from a tensor of masks, such as SAM's: the result of `post_process_masks` of transformers.js for
 * one image (bool, 1 × 3 × height × width), or any tensor whose last two dimensions are height and width.
 *
 * @param tensor bool or integers, where non-zero is the object; or floats, which are logits, above 0 for the object
 * @param choice which of several masks: its `index` in the tensor, or `scores` (`iou_scores`), of which the highest wins
 * @returns 1 is the object
 *
 * @example
 * const [masks] = await processor.post_process_masks(pred_masks, original_sizes, reshaped_input_sizes);
 * const mask = fromTensor(masks, "mask", { scores: iou_scores });
 * @throws {@link Sim3AlignError} if dimensions and data do not match, or no mask is selected
 */
export function fromTensor(tensor: TensorLike, content: "mask", choice?: MaskChoice): PixelArray<Uint8Array>;
export function fromTensor(
  tensor: TensorLike,
  content: "depth" | "mask",
  choice: MaskChoice = {},
): PixelArray<Float32Array> | PixelArray<Uint8Array> {
  const isDepth = oneOf("content", content, ["depth", "mask"], "INVALID_ARGUMENT") === "depth";
  return isDepth ? depthFrom(tensor) : maskFrom(tensor, choice);
}

function maskFrom(tensor: unknown, choice: MaskChoice): PixelArray<Uint8Array> {
  const { index, scores } = withForeignObject("choice", "{ index } or { scores }", () => {
    const { data = choice?.scores } = Object(choice?.scores) as { data?: unknown };
    return record("choice", isRecord(choice) ? { ...choice, scores: data } : choice, "{ index } or { scores }");
  }) as { index?: number; scores?: ArrayLike<number> };
  const { data, width, height, count } = dimensions(tensor);
  const chosen = index ?? (scores === undefined ? undefined : best(scores, count)) ?? (count === 1 ? 0 : undefined);
  if (chosen === undefined || !Number.isInteger(chosen) || chosen < 0 || chosen >= count) {
    const found = chosen === undefined ? `no choice among ${count} masks` : describe(chosen);
    const remedy = "Pass { scores: iou_scores }, or the index of a mask.";
    throw failure("INVALID_OPTION", "choice", found, `an index below ${count}, or scores`, remedy);
  }
  const values = data as ArrayLike<number>;
  const mask = new Uint8Array(width * height);
  const isLogit = isTypedArray(data, "Float16Array", "Float32Array", "Float64Array");
  for (let i = 0; i < mask.length; i++) {
    const value = values[chosen * mask.length + i] ?? 0;
    mask[i] = (isLogit ? value > 0 : Number(value) !== 0) ? 1 : 0;
  }
  return { data: mask, width, height };
}

function best(scores: ArrayLike<number>, count: number): number {
  const numbers = flattened(scores) as number[] | null;
  if (numbers?.length !== count) {
    const found = numbers === null ? describe(scores) : `${numbers.length} scores`;
    throw failure("WRONG_LENGTH", "choice.scores", found, `one for each of ${count} masks`, "Pass iou_scores.");
  }
  return numbers.indexOf(Math.max(...numbers));
}

function depthFrom(tensor: unknown): PixelArray<Float32Array> {
  const { data, width, height, count } = dimensions(tensor);
  if (count !== 1) {
    const remedy = "Pass the map of one image: tensor[0].";
    throw failure("WRONG_LENGTH", "tensor.dims", `${count} maps`, "one depth map", remedy);
  }
  if (isTypedArray<Float32Array>(data, "Float32Array")) return { data, width, height };
  if (isTypedArray<Float64Array>(data, "Float64Array", "Float16Array")) {
    return { data: Float32Array.from(data), width, height };
  }
  const isPicture = isTypedArray(data, "Uint8Array", "Uint8ClampedArray");
  const remedy = isPicture ? "256 levels are a visualisation of depth: pass predicted_depth." : "Pass predicted_depth.";
  const code = isPicture ? "EIGHT_BIT_DEPTH" : "INVALID_ARGUMENT";
  throw failure(code, "tensor.data", describe(data), "a Float32Array", remedy);
}
