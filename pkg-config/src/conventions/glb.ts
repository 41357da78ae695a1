/** Export of placed meshes, and placement of existing GLB files. */

import type { Sim3Like } from "../types/argument-types.js";
import type { MeshArrays } from "../types/inputs.js";
import { oneOf, optionsOf } from "../values/values.js";
import { inFrame } from "./frames.js";
import { readGlb, writeGlb } from "./glb-file.js";
import { GltfDocument, objectsOf, shownNodes } from "./gltf-document.js";
import { type GltfNode, type GltfNodeOptions, toGltfNode } from "./gltf-node.js";
import { meshOf } from "./mesh.js";
import { applyToPoints, sim3Of, similarityOf } from "./similarity.js";

/** Options of {@link exportGlb}. */
export interface GlbOptions extends GltfNodeOptions {
  /** "node", the default, keeps the vertices and transforms the node; "baked" transforms the vertices. */
  mode?: "node" | "baked" | undefined;
}

/**
 * Exports a mesh at its pose relative to a camera at the origin, in metres, as a GLB file. The file contains positions
 * and triangles only; {@link placeGlb} keeps the materials of a GLB.
 *
 * @param mesh `positions` and `indices` of the aligned mesh
 * @param transform OpenCV camera from mesh: a result of `align`, whose metrics are kept in the node's extras
 *
 * @example
 * const bytes = exportGlb(mesh, result);
 * await writeFile("placed.glb", bytes);
 * @throws {@link Sim3AlignError} for an invalid mesh or transform, and `INVALID_OPTION`
 */
export function exportGlb(mesh: MeshArrays, transform: Sim3Like, options: GlbOptions = {}): Uint8Array {
  const { positions, indices } = meshOf("mesh", mesh);
  const { mode = "node", ...ofNode } = optionsOf(options, ["mode", "frame", "metrics", "name"]);
  const isBaked = oneOf("options.mode", mode, ["node", "baked"]) === "baked";
  const node = toGltfNode(transform, ofNode);
  const placed = sim3Of(inFrame("options.frame", similarityOf(transform), ofNode.frame ?? "opengl"));
  const document = new GltfDocument();
  const added = document.addMesh({ positions: isBaked ? applyToPoints(placed, positions) : positions, indices });
  const { name, extras } = node;
  return writeGlb(document.finish([document.push("nodes", { ...(isBaked ? { name, extras } : node), mesh: added })]));
}

/**
 * Places an existing GLB by adding a parent node above its scene. Materials, textures and animations are kept; nothing
 * is decoded.
 *
 * @param glb the bytes of the aligned file
 * @param transform OpenCV camera from mesh: a result of `align` for the same file
 *
 * @example
 * const bytes = placeGlb(generated, await aligner.align({ depth, mask, camera, mesh: generated }));
 * @throws {@link Sim3AlignError} `CORRUPT_FILE` if the bytes are not a GLB, `UNSUPPORTED_FORMAT` for glTF 1
 */
export function placeGlb(
  glb: Uint8Array | ArrayBuffer,
  transform: Sim3Like,
  options: GltfNodeOptions = {},
): Uint8Array {
  return underNode(glb, toGltfNode(transform, options));
}

/** A GLB with one more node above its scene. */
export function underNode(glb: Uint8Array | ArrayBuffer, parent: Partial<GltfNode>): Uint8Array {
  const { json, chunks } = readGlb(glb);
  const nodes = objectsOf(json, "nodes");
  const scene = typeof json.scene === "number" ? json.scene : 0;
  const scenes = json.scenes === undefined ? [{}] : objectsOf(json, "scenes");
  const placed = {
    ...json,
    scene,
    scenes: scenes.map((other, i) => (i === scene ? { ...other, nodes: [nodes.length] } : other)),
    nodes: [...nodes, withChildren(parent, shownNodes(json))],
  };
  return writeGlb({ json: placed, chunks });
}

/** A node with these children; glTF does not allow an empty list. */
export const withChildren = <T extends object>(node: T, children: number[]): T & { children?: number[] } =>
  children.length > 0 ? { ...node, children } : node;
