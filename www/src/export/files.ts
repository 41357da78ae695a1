/** Writers of results, in formats that other programs read. */
import type { Sim3 } from "sim3align";
import { compose, exportGlb, exportPly, exportSceneGlb, invert, toBop, toRowMajor } from "sim3align/conventions";
import { videoWork } from "../alignment/video.js";
import { poseIn, sceneResult, videoResult } from "../session/results.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import type { Scene } from "../state/scene.js";

const { support } = page;

/** The 16 numbers of a pose as a JSON array of four lines. */
export function matrixText({ pose }: ObjectModel, order: "column" | "row"): string {
  const { transform } = pose.value;
  const numbers = order === "column" ? transform.matrix : toRowMajor(transform);
  return `[${Array.from({ length: 4 }, (_, i) => numbers.slice(4 * i, 4 * i + 4).join(", ")).join(",\n ")}]`;
}

/** The poses of the video that is shown, by the name of its object. */
export const videoText = (name: string): string =>
  JSON.stringify({ [name]: videoResult(page.video.value?.frames ?? [], videoWork()) }, null, 2);

/** The results of a scene. */
export const jsonText = (scene: Scene): string => JSON.stringify(sceneResult(scene, page.inputs.peek()), null, 2);

/** The results of all scenes of the list. */
export const allJsonText = async (): Promise<string> =>
  JSON.stringify((await import("../session/project.js")).allResults(), null, 2);

/** BOP's `scene_gt.json`. BOP models are in millimetres, so each entry holds the factor for the mesh. */
export function bopText({ objects }: Scene): string {
  const entries = objects.flatMap(({ isPlaced, pose, name }, i) => {
    const { entry, scale } = toBop(pose.value.transform, { objId: i + 1 });
    return isPlaced ? [{ ...entry, name, model_mm_per_mesh_unit: 1000 * scale }] : [];
  });
  return JSON.stringify({ 0: entries }, null, 2);
}

/** The mesh at its pose and metric scale. A GLB keeps its materials. */
export function glbBytes({ pose, mesh, glb }: ObjectModel): Uint8Array {
  const { transform } = pose.value;
  return exportGlb(glb ?? mesh, transform);
}

/** All placed objects in one GLB, in metres, y up; on the ground at y = 0 if the support is known. */
export function sceneBytes({ objects }: Scene): Uint8Array {
  const placed = objects.filter(({ isPlaced }) => isPlaced);
  const nodes = placed.map(({ name, mesh, glb, pose }) => ({
    name,
    mesh: glb ?? mesh,
    transform: pose.value.transform,
  }));
  return exportSceneGlb(nodes, { support: support.value });
}

/** Frames per second of an animation; videos of depth maps do not say how fast they are. */
const FRAME_RATE = 30;

/** The object as it moves through the video, with the camera, in the frame of the first camera. */
export function videoBytes(scene: Scene, { name, mesh, glb }: ObjectModel): Uint8Array {
  const { framePoses, frameWorks } = videoWork();
  const { cameras = null } = page.video.peek() ?? {};
  const toFirst = cameras?.map((camera) => compose(invert(cameras[0] ?? camera), camera));
  const timed = (i: number, transform: Sim3) => ({ timeS: i / FRAME_RATE, transform });
  const motion = framePoses.flatMap((pose, i) => {
    const transform = poseIn(pose, frameWorks[i]);
    const first = toFirst?.[i];
    return transform === null ? [] : [timed(i, first === undefined ? transform : compose(first, transform))];
  });
  const [start] = motion;
  if (start === undefined) throw new Error("No frame has a pose yet: track the video first.");
  const { camera, width, height } = scene;
  const moving = { ...camera, width, height, motion: toFirst?.map((transform, i) => timed(i, transform)) };
  return exportSceneGlb([{ name, mesh: glb ?? mesh, transform: start.transform, motion }], { camera: moving });
}

/** The mesh at its pose and metric scale as PLY, in the OpenCV camera frame. */
export const plyBytes = ({ pose, mesh }: ObjectModel): Uint8Array => exportPly(mesh, pose.value.transform);
