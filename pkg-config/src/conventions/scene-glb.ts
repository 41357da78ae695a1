/** Export of a whole scene as one GLB. */

import type { Sim3Like } from "../types/argument-types.js";
import type { MeshArrays } from "../types/inputs.js";
import { invalidArgument } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { finite, flattened, optionsOf, record, type Vector3 } from "../values/validation.js";
import { withChildren } from "./glb.js";
import { readGlb, writeGlb } from "./glb-file.js";
import { GltfDocument } from "./gltf-document.js";
import { gltfNode } from "./gltf-node.js";
import { meshOf } from "./mesh.js";
import { Names } from "./names.js";
import { meanOf, minus, norm, quaternionOf } from "./rotation.js";
import { type SceneCamera, sceneCamera, sceneFromCamera, sceneObjects } from "./scene-frame.js";
import { composed, type Similarity, sim3Of, similarityOf } from "./similarity.js";

/** An object of a scene to export. */
export interface SceneGlbObject {
  /** The name of its node. */
  name?: string | undefined;
  /** The aligned mesh: a GLB, whose materials and textures are kept, or arrays. */
  mesh: Uint8Array | ArrayBuffer | MeshArrays;
  /** OpenCV camera from mesh, metres: an object of the result of `alignScene`. */
  transform: Sim3Like;
  /** Its poses over time, in order: an animation of its node. */
  motion?: readonly TimedPose[] | undefined;
}

/** A pose of a moving object or camera. */
export interface TimedPose {
  /** Seconds, from 0 on. */
  timeS: number;
  /** OpenCV camera from mesh or, of a moving camera, from the camera's present frame to that of the first. */
  transform: Sim3Like;
}

/** Options of {@link exportSceneGlb}. */
export interface SceneGlbOptions {
  /** The plane that the objects stand on, as `support` of the result: it becomes the ground, y = 0. */
  support?: { normal: ArrayLike<number>; d: number } | null | undefined;
  /** The camera; its principal point does not count, because cameras of glTF have none. */
  camera?: (SceneCamera & { motion?: readonly TimedPose[] | undefined }) | undefined;
}

/** glTF cameras look along −z, with y up. */
const BACKWARDS: Similarity = { scale: 1, rotation: [1, 0, 0, 0, -1, 0, 0, 0, -1], translation: [0, 0, 0] };

/** Half the side of the ground: this factor times the largest distance of an object from their mean, plus this many metres. */
const GROUND = [1.6, 0.2] as const;

/**
 * Exports a scene as one GLB in metres: a node per object, the camera and the ground. With a support, y is up, the
 * ground is y = 0 and the origin is the foot of the objects' centre; without one, the frame is that of the glTF camera at
 * the origin. Objects and a camera with a `motion` are animated, with a key for each pose.
 *
 * @example
 * const { objects, support } = await aligner.alignScene(scene);
 * const bytes = exportSceneGlb([{ name: "mug", mesh: mugGlb, transform: objects[0] }], { support });
 * @throws {@link Sim3AlignError} for an invalid mesh, GLB or transform
 */
export function exportSceneGlb(objects: readonly SceneGlbObject[], options: SceneGlbOptions = {}): Uint8Array {
  const { support = null, camera } = optionsOf(options, ["support", "camera"]);
  const parts = sceneObjects(objects, (i) => `object ${i}`);
  const names = new Names((name) => name);
  const document = new GltfDocument();
  const centers = parts.map(({ transform }) => similarityOf(transform).translation);
  const { rotation, translation } = sceneFromCamera(support, centers, "y");
  const children = parts.map(({ name, mesh, transform }) => {
    const node = gltfNode(transform, { name: names.own(name), frame: "opencv" });
    if (!isRecord(mesh)) return document.push("nodes", withChildren(node, document.add(readGlb(mesh))));
    return document.push("nodes", { ...node, mesh: document.addMesh(meshOf("mesh", mesh)) });
  });
  const moving = parts.map(({ motion }, i) => ({ node: children[i] as number, keys: keysOf(`objects[${i}]`, motion) }));
  if (camera !== undefined) {
    const node = addCamera(document, camera);
    children.push(node);
    const keys = keysOf("options.camera", camera.motion).map(({ pose, ...key }) => ({
      ...key,
      pose: composed(pose, BACKWARDS),
    }));
    moving.push({ node, keys });
  }
  addAnimation(document, moving);
  const view = { name: "view", rotation: quaternionOf(rotation), translation, children };
  const roots = [document.push("nodes", view)];
  if (support !== null) roots.push(addGround(document, reachOf(centers)));
  return writeGlb(document.finish(roots));
}

/** A key of an animation. */
interface Key {
  timeS: number;
  pose: Similarity;
}

/** @throws if times do not increase, or one is before 0 */
function keysOf(owner: string, motion: readonly TimedPose[] = []): Key[] {
  const list = flattened(motion);
  const [argument, expected] = [`${owner}.motion`, "an array of { timeS, transform }, by increasing times from 0 on"];
  const remedy = "Pass one of these per frame, such as timeS: index / 30.";
  if (list === null) throw invalidArgument(argument, motion, expected, remedy);
  let before = -1;
  return list.map((one, i) => {
    const { timeS, transform } = record(`${argument}[${i}]`, one, "{ timeS, transform }");
    const time = Math.fround(finite(`${argument}[${i}].timeS`, timeS));
    if (time < 0 || time <= before) throw invalidArgument(`${argument}[${i}].timeS`, timeS, expected, remedy);
    before = time;
    return { timeS: time, pose: similarityOf(transform, `${argument}[${i}].transform`) };
  });
}

/** Adds the animation of the nodes that move, if there are any. */
function addAnimation(document: GltfDocument, moving: readonly { node: number; keys: readonly Key[] }[]): void {
  const samplers: object[] = [];
  const channels: object[] = [];
  for (const { node, keys } of moving.filter(({ keys }) => keys.length > 0)) {
    const input = document.addValues(keys.map(({ timeS }) => [timeS]));
    const poses = keys.map(({ pose }) => sim3Of(pose));
    const tracks = {
      translation: poses.map(({ translation }) => translation),
      rotation: poses.map(({ rotation }) => rotation),
      scale: poses.map(({ scale }) => [scale, scale, scale]),
    };
    for (const [path, values] of Object.entries(tracks)) {
      const sampler = samplers.push({ input, output: document.addValues(values) }) - 1;
      channels.push({ sampler, target: { node, path } });
    }
  }
  if (channels.length > 0) document.push("animations", { name: "motion", samplers, channels });
}

function reachOf(centers: readonly Vector3[]): number {
  const center = meanOf(centers);
  return GROUND[0] * Math.max(0, ...centers.map((c) => norm(minus(c, center)))) + GROUND[1];
}

function addGround(document: GltfDocument, reach: number): number {
  const positions = new Float32Array([-reach, 0, -reach, -reach, 0, reach, reach, 0, reach, reach, 0, -reach]);
  const material = document.push("materials", {
    name: "ground",
    pbrMetallicRoughness: { baseColorFactor: [0.6, 0.6, 0.6, 1], metallicFactor: 0, roughnessFactor: 1 },
    doubleSided: true,
  });
  const mesh = document.addMesh({ positions, indices: Uint32Array.of(0, 1, 2, 0, 2, 3) }, material);
  return document.push("nodes", { name: "support", mesh });
}

function addCamera(document: GltfDocument, given: unknown): number {
  const { fovYRad, fx, fy, width, height } = sceneCamera(given);
  const perspective = { yfov: fovYRad, aspectRatio: (width * fy) / (height * fx), znear: 0.01 };
  const camera = document.push("cameras", { type: "perspective", perspective });
  return document.push("nodes", { name: "camera", camera, rotation: quaternionOf(BACKWARDS.rotation) });
}
