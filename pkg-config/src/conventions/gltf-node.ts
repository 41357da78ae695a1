/** Transforms as glTF nodes. */
import type { Sim3Like } from "../input/sim3.js";
import { plainArgument } from "../values/border.js";
import { isRecord } from "../values/kinds.js";
import { optionsOf, type Quaternion, text, type Vector3 } from "../values/validation.js";
import { type CameraFrame, inFrame } from "./frames.js";
import { sim3Of, similarityOf } from "./similarity.js";

/** Options of the node of an exported mesh. */
export interface GltfNodeOptions {
  /**
   * The parent frame of the node: "opengl", the default, is the frame of glTF cameras; "opencv" keeps the transform
   * unchanged.
   */
  frame?: "opengl" | "opencv" | undefined;
  /** Stored in the extras of the node. Default: the metrics of the result. */
  metrics?: object | null | undefined;
  /** The name of the node. Default "sim3align". */
  name?: string | undefined;
}

/** A glTF node: translation, rotation, uniform scale, and extras. */
export interface GltfNode {
  name: string;
  /** Metres. */
  translation: Vector3;
  /** x, y, z, w. */
  rotation: Quaternion;
  scale: Vector3;
  extras: { sim3align: { frame: CameraFrame; metresPerUnit: number; [fact: string]: unknown } };
}

/** The node that places a mesh at its pose relative to a camera at the origin; metrics and confidence are in its extras. */
export function gltfNode(transform: Sim3Like, options: GltfNodeOptions = {}): GltfNode {
  const { frame = "opengl", metrics, name = "sim3align" } = optionsOf(options, ["frame", "metrics", "name"]);
  const { scale, rotation, translation } = sim3Of(inFrame("options.frame", similarityOf(transform), frame));
  const known = { metrics, ...factsOf(plainArgument("transform", transform), metrics) };
  const facts = Object.fromEntries(Object.entries(known).filter(([, fact]) => fact !== undefined && fact !== null));
  const extras = { sim3align: { frame, metresPerUnit: scale, ...facts } };
  return { name: text("options.name", name), translation, rotation, scale: [scale, scale, scale], extras };
}

/** Metrics and confidence of an alignment. */
function factsOf(transform: unknown, metrics: unknown): { metrics?: unknown; confidence?: unknown } {
  if (!isRecord(transform)) return { metrics };
  const { metrics: own, confidence } = transform;
  return { metrics: metrics === undefined ? own : metrics, confidence };
}
