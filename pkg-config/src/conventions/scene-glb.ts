/** Export of a whole scene as one GLB. */

import type { Sim3Like } from "../input/sim3.js";
import type { MeshArrays } from "../input/types.js";
import { invalidArgument } from "../values/error.js";
import { flattened, isRecord, optionsOf, positive, record, type Vector3 } from "../values/values.js";
import { bounds, bytesOf, glbOfParts, partsOf } from "./glb.js";
import { type GltfNode, toGltfNode } from "./gltf-node.js";
import { groundFrame, meanOf, minus } from "./ground-frame.js";
import { MergedGltf } from "./merged-gltf.js";
import { meshOf } from "./mesh.js";
import { dot, quaternionOf } from "./rotation.js";
import { similarityOf } from "./similarity.js";

/** An object of a scene to export. */
export interface SceneGlbObject {
  /** The name of its node. */
  name?: string | undefined;
  /** The aligned mesh: a GLB, whose materials and textures are kept, or arrays. */
  mesh: Uint8Array | ArrayBuffer | MeshArrays;
  /** OpenCV camera from mesh, metres: an object of the result of `alignScene`. */
  transform: Sim3Like;
}

/** Options of {@link exportSceneGlb}. */
export interface SceneGlbOptions {
  /** The plane that the objects stand on, as `support` of the result: it becomes the ground, y = 0. */
  support?: { normal: ArrayLike<number>; d: number } | null | undefined;
  /** The camera: its intrinsics, and the size of its image in pixels. */
  camera?: { fy: number; width: number; height: number } | undefined;
}

/** Half the side of the ground: this factor times the largest distance of an object from their mean, plus this many metres. */
const GROUND = [1.6, 0.2] as const;

/**
 * Exports a scene as one GLB in metres: a node per object, the camera and the ground. With a support, y is up, the
 * ground is y = 0 and the origin is the foot of the objects' centre; without one, the frame is that of the glTF camera at
 * the origin.
 *
 * @example
 * const { objects, support } = await aligner.alignScene(scene);
 * const bytes = exportSceneGlb([{ name: "mug", mesh: mugGlb, transform: objects[0] }], { support });
 * @throws {@link Sim3AlignError} for an invalid mesh, GLB or transform
 */
export function exportSceneGlb(objects: readonly SceneGlbObject[], options: SceneGlbOptions = {}): Uint8Array {
  const { support = null, camera } = optionsOf(options);
  const list = flattened(objects);
  if (list === null) {
    throw invalidArgument("objects", objects, "an array of { mesh, transform }", "Pass one of these per object.");
  }
  const given = list.map((object, i) => record(`objects[${i}]`, object, "{ mesh, transform }"));
  const parts = given as unknown as SceneGlbObject[];
  const merged = new MergedGltf();
  const centers = parts.map(({ transform }) => similarityOf(transform).translation);
  const { rotation, translation } = worldFromCamera(support, centers);
  const children = parts.map(({ name, mesh, transform }, i) => {
    const node: GltfNode & { children?: number[]; mesh?: number } = toGltfNode(transform, {
      name: name ?? `object ${i}`,
      frame: "opencv",
    });
    if (isRecord(mesh)) node.mesh = addMesh(merged, mesh as unknown as MeshArrays);
    else {
      const shown = merged.add(partsOf(mesh));
      // glTF does not allow an empty list of children.
      if (shown.length > 0) node.children = shown;
    }
    return merged.push("nodes", node);
  });
  if (camera !== undefined) children.push(addCamera(merged, record("options.camera", camera, "{ fy, width, height }")));
  const roots = [merged.push("nodes", { name: "view", rotation, translation, children })];
  if (support !== null) roots.push(addGround(merged, reachOf(centers)));
  return glbOfParts(merged.finish(roots));
}

/** The turn and the shift from the OpenCV camera frame to that of the file. */
function worldFromCamera(support: Parameters<typeof groundFrame>[0], centers: readonly Vector3[]) {
  const { right, up, back, origin } = groundFrame(support, centers);
  const [x, y, z] = [right, up, back].map((row) => -dot(row, origin)) as Vector3;
  return { rotation: quaternionOf([...right, ...up, ...back]), translation: [x, y, z] };
}

function reachOf(centers: readonly Vector3[]): number {
  const center = meanOf(centers);
  const distances = centers.map((c) => Math.sqrt(dot(minus(c, center), minus(c, center))));
  return GROUND[0] * Math.max(0, ...distances) + GROUND[1];
}

function addMesh(merged: MergedGltf, mesh: MeshArrays): number {
  const { positions, indices } = meshOf("mesh", mesh);
  return addTriangles(merged, positions, indices === null ? null : Uint32Array.from(indices), undefined);
}

function addTriangles(
  merged: MergedGltf,
  positions: Float32Array,
  corners: Uint32Array | null,
  material: number | undefined,
): number {
  const view = (array: Float32Array | Uint32Array, target: number) => {
    const bytes = bytesOf(array);
    return merged.push("bufferViews", {
      ...{ buffer: 0, byteOffset: merged.addBinary(bytes), byteLength: bytes.length, target },
    });
  };
  const position = merged.push("accessors", {
    ...{ bufferView: view(positions, 34962), componentType: 5126, type: "VEC3", count: positions.length / 3 },
    ...bounds(positions),
  });
  const indices =
    corners === null
      ? {}
      : {
          indices: merged.push("accessors", {
            ...{ bufferView: view(corners, 34963), componentType: 5125, type: "SCALAR", count: corners.length },
          }),
        };
  const primitive = { attributes: { POSITION: position }, ...indices };
  return merged.push("meshes", { primitives: [material === undefined ? primitive : { ...primitive, material }] });
}

function addGround(merged: MergedGltf, reach: number): number {
  const positions = new Float32Array([-reach, 0, -reach, -reach, 0, reach, reach, 0, reach, reach, 0, -reach]);
  const material = merged.push("materials", {
    name: "ground",
    pbrMetallicRoughness: { baseColorFactor: [0.6, 0.6, 0.6, 1], metallicFactor: 0, roughnessFactor: 1 },
    doubleSided: true,
  });
  const mesh = addTriangles(merged, positions, new Uint32Array([0, 1, 2, 0, 2, 3]), material);
  return merged.push("nodes", { name: "support", mesh });
}

function addCamera(merged: MergedGltf, given: Record<string, unknown>): number {
  const number = (name: string) => positive(`options.camera.${name}`, given[name]);
  const [fy, width, height] = [number("fy"), number("width"), number("height")];
  const camera = merged.push("cameras", {
    type: "perspective",
    perspective: { yfov: 2 * Math.atan(height / (2 * fy)), aspectRatio: width / height, znear: 0.01 },
  });
  // glTF cameras look along −z, with y up.
  return merged.push("nodes", { name: "camera", camera, rotation: [1, 0, 0, 0] });
}
