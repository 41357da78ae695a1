/**
 * Models of the page's host that see depth and mask in a photo. The page itself loads none, and asks the network for nothing.
 *
 * A host that loads models sets `globalThis.sim3alignPhotoModel` before the user marks an object: a title, and the function that
 * `loadModels` of `examples/06-transformersjs` returns.
 */
import type { DepthKind } from "sim3align";
import { fromTensor } from "sim3align/conventions";
import type { TensorLike } from "sim3align/conventions/tensor";

/** What a model returns, as transformers.js does; a host may leave out the depth or the mask. */
export interface Seen {
  /** Height × width floats. */
  predicted_depth?: TensorLike;
  /** What the values of the depth are. */
  depthKind?: DepthKind;
  /** Of one image, from `post_process_masks` of SAM. */
  masks?: TensorLike;
  iou_scores?: TensorLike;
}

export interface PhotoModel {
  /** Shown on a button, such as "SAM and Depth Anything". */
  title: string;
  /** Looks at a photo, and at the object at a place in it: shares of its width and height. */
  see(photo: Blob, place: readonly [right: number, down: number]): Promise<Seen>;
}

declare global {
  var sim3alignPhotoModel: PhotoModel | undefined;
}

interface Found {
  depth: { data: Float32Array; width: number; height: number } | null;
  depthKind: DepthKind;
  mask: { data: Uint8Array; width: number; height: number } | null;
}

/** What the model of the host sees. */
export async function seenBy(model: PhotoModel, photo: Uint8Array, place: readonly [number, number]): Promise<Found> {
  const seen = await model.see(new Blob([photo as Uint8Array<ArrayBuffer>]), place);
  const { predicted_depth, depthKind = "metric", masks, iou_scores } = seen;
  const found = masks && fromTensor(masks, "mask", iou_scores === undefined ? {} : { scores: iou_scores });
  return {
    depth: predicted_depth === undefined ? null : fromTensor(predicted_depth, "depth"),
    depthKind,
    mask: found === undefined ? null : { ...found, data: Uint8Array.from(found.data) },
  };
}
