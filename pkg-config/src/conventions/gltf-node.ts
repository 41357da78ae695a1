/** Transforms as nodes of glTF. */
import type { Sim3Like } from "../sim3.js";
import type { Quaternion, Vector3 } from "../values.js";
import { isRecord } from "../values.js";
import { type CameraFrame, inFrame } from "./frames.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** What {@link toGltfNode} can be told. */
export interface GltfNodeOptions {
  /**
   * The frame that the node leads into: "opengl" by default, which is that of glTF's own cameras; "opencv" for readers
   * who want the transform as it is.
   */
  frame?: "opengl" | "opencv" | undefined;
  /** Kept in the node's extras; by default the metrics that a result of `align` has. */
  metrics?: object | null | undefined;
  /** The node's name. Default "sim3align". */
  name?: string | undefined;
}

/** A node of glTF: translation, rotation, one scale for all axes, and what is known about them. */
export interface GltfNode {
  name: string;
  /** Metres. */
  translation: Vector3;
  /** x, y, z, w. */
  rotation: Quaternion;
  scale: Vector3;
  extras: { sim3align: { frame: CameraFrame; metresPerUnit: number; [fact: string]: unknown } };
}

/**
 * A transform as a node of glTF, under which the mesh is where it really is, at its real size, seen from a camera at the
 * origin. Metrics and confidence, where there are any, are in `extras.sim3align`.
 *
 * @param transform OpenCV camera from mesh, metres
 *
 * @example
 * gltf.nodes.push({ ...toGltfNode(result), mesh: 0 });
 * @throws {@link Sim3AlignError} for what is no similarity, and `INVALID_OPTION` for a frame that does not exist
 */
export function toGltfNode(
  transform: Sim3Like,
  { frame = "opengl", metrics, name = "sim3align" }: GltfNodeOptions = {},
): GltfNode {
  const { scale, rotation, translation } = sim3Of(inFrame("options.frame", similarityOf(transform), frame));
  const known = { metrics, ...factsOf(transform, metrics) };
  const facts = Object.fromEntries(Object.entries(known).filter(([, fact]) => fact !== undefined && fact !== null));
  const extras = { sim3align: { frame, metresPerUnit: scale, ...facts } };
  return { name, translation, rotation, scale: [scale, scale, scale], extras };
}

/** What a result of `align` says about itself. */
function factsOf(transform: unknown, metrics: unknown): { metrics?: unknown; confidence?: unknown } {
  if (!isRecord(transform)) return { metrics };
  const { metrics: own, confidence } = transform;
  return { metrics: metrics === undefined ? own : metrics, confidence };
}
