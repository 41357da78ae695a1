/** Writers of results, in formats that other programs read. */
import { exportGlb, exportPly, exportSceneGlb, toBop, toRowMajor } from "sim3align/conventions";
import { videoWork } from "../alignment/video.js";
import { sceneResult, videoResult } from "../session/results.js";
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

/** The mesh at its pose and metric scale as PLY, in the OpenCV camera frame. */
export const plyBytes = ({ pose, mesh }: ObjectModel): Uint8Array => exportPly(mesh, pose.value.transform);
