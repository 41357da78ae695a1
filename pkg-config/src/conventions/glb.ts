/** Export of placed meshes as GLB files. */

import { isContent } from "../input/bytes.js";
import type { Sim3Like } from "../types/argument-types.js";
import type { MeshArrays } from "../types/inputs.js";
import { failure } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { oneOf, optionsOf } from "../values/validation.js";
import { inFrame } from "./frames.js";
import { readGlb, writeGlb } from "./glb-file.js";
import { GltfDocument, objectsOf, shownNodes } from "./gltf-document.js";
import { type GltfNode, type GltfNodeOptions, gltfNode } from "./gltf-node.js";
import { meshOf } from "./mesh.js";
import { applyToPoints, sim3Of, similarityOf } from "./similarity.js";

/** Options of {@link exportGlb}. */
export interface GlbOptions extends GltfNodeOptions {
  /** "node", the default, keeps the vertices and transforms the node; "baked" transforms the vertices. */
  mode?: "node" | "baked" | undefined;
}

/**
 * Exports a mesh at its pose relative to a camera at the origin, in metres, as a GLB file. Of arrays, it contains positions
 * and triangles only. A GLB gets one more node above its scene: materials, textures and animations are kept, nothing is
 * decoded.
 *
 * @param mesh the aligned mesh: `positions` and `indices`, or the bytes of a GLB
 * @param transform OpenCV camera from mesh: a result of `align`, whose metrics and confidence are kept in `extras.sim3align`
 * of the node
 *
 * @example
 * const bytes = exportGlb(generated, await aligner.align({ depth, mask, camera, mesh: generated }));
 * await writeFile("placed.glb", bytes);
 * @throws {@link Sim3AlignError} for an invalid mesh or transform, `INVALID_OPTION`, `CORRUPT_FILE` for bytes that are not a
 * GLB, and `UNSUPPORTED_FORMAT` for glTF 1
 */
export function exportGlb(
  mesh: MeshArrays | Uint8Array | ArrayBuffer,
  transform: Sim3Like,
  options: GlbOptions = {},
): Uint8Array {
  const { mode = "node", ...ofNode } = optionsOf(options, ["mode", "frame", "metrics", "name"]);
  const isBaked = oneOf("options.mode", mode, ["node", "baked"]) === "baked";
  const node = gltfNode(transform, ofNode);
  if (isContent(mesh)) {
    if (!isBaked) return underNode(mesh, node);
    const remedy = 'Pass the arrays of the mesh, or omit mode: "node" keeps what else is in the file.';
    throw failure("INVALID_OPTION", "options.mode", '"baked" for the bytes of a GLB', '"node"', remedy);
  }
  const { positions, indices } = meshOf("mesh", mesh);
  const placed = sim3Of(inFrame("options.frame", similarityOf(transform), ofNode.frame ?? "opengl"));
  const document = new GltfDocument();
  const added = document.addMesh({ positions: isBaked ? applyToPoints(placed, positions) : positions, indices });
  const { name, extras } = node;
  return writeGlb(document.finish([document.push("nodes", { ...(isBaked ? { name, extras } : node), mesh: added })]));
}

/** A GLB with one more node above its scene. */
export function underNode(glb: Uint8Array | ArrayBuffer, parent: Partial<GltfNode>): Uint8Array {
  const { json, chunks } = readGlb(glb);
  const nodes = objectsOf(json, "nodes");
  const scene = typeof json.scene === "number" ? json.scene : 0;
  const scenes = json.scenes === undefined ? [{}] : objectsOf(json, "scenes");
  const { asset, ...content } = json;
  const { generator, ...facts } = isRecord(asset) ? asset : {};
  const programs = typeof generator === "string" ? `${generator}, placed by sim3align` : "sim3align";
  const placed = {
    asset: { ...facts, generator: programs },
    ...content,
    scene,
    scenes: scenes.map((other, i) => (i === scene ? { ...other, nodes: [nodes.length] } : other)),
    nodes: [...nodes, withChildren(parent, shownNodes(json))],
  };
  return writeGlb({ json: placed, chunks });
}

/** A node with these children; glTF does not allow an empty list. */
export const withChildren = <T extends object>(node: T, children: number[]): T & { children?: number[] } =>
  children.length > 0 ? { ...node, children } : node;
