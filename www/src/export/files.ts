/** What leaves the page: files, in the forms that other programs read. */
import type { Metrics } from "sim3align";
import { exportGlb, exportPly, placeGlb, type Sim3, toBop, toRowMajor } from "sim3align/conventions";
import type { ObjectModel } from "../state/object-model.js";
import { alignOptions } from "../state/options.js";
import type { Scene } from "../state/scene.js";

/** A pose as text: 16 numbers, in four lines, as a program would have them. */
export function matrixText({ pose }: ObjectModel, order: "columns" | "rows"): string {
  const { transform } = pose.value;
  const numbers = order === "columns" ? transform.matrix : toRowMajor(transform);
  return `[${Array.from({ length: 4 }, (_, i) => Array.from(numbers.slice(4 * i, 4 * i + 4)).join(", ")).join(",\n ")}]`;
}

const plain = ({ matrix, scale, rotationMatrix, rotation, translation }: Sim3) => ({
  scale,
  rotation: rotationMatrix,
  quaternion: rotation,
  translation,
  matrix: Array.from(matrix),
});

/** An object's name as a key that no other has. */
export function keyOf(scene: Scene, object: ObjectModel): string {
  const alike = scene.objects.filter(({ name }) => name === object.name);
  return alike.length === 1 ? object.name : `${object.name} ${Number(object.id) + 1}`;
}

interface JsonEntry extends ReturnType<typeof plain> {
  source: string;
  sizeM: number[];
  confidence: number | null;
  metrics: Metrics | null;
  alternatives: ReturnType<typeof plain>[];
}

function jsonEntry({ pose, box, alignment, metrics }: ObjectModel): JsonEntry {
  const { transform, source } = pose.value;
  const found = alignment.value;
  return {
    ...plain(transform),
    source,
    sizeM: [...box.value.sizeM],
    // It is about the alignment's own pose, and not about what somebody has made of it.
    confidence: source === "aligned" || source === "refined" ? (found?.confidence ?? null) : null,
    metrics: metrics.value,
    alternatives: found?.alternatives.map(plain) ?? [],
  };
}

/** Every object's pose, by name: what the command line's `--transform` and `--initial` take. */
export function jsonText(scene: Scene): string {
  const entries = scene.objects.map((object) => [keyOf(scene, object), jsonEntry(object)]);
  return JSON.stringify({ ...Object.fromEntries(entries), _about: about(scene) }, null, 2);
}

const about = ({ camera, width, height }: Scene) => ({
  convention: "x_cam = scale · rotation · p_mesh + translation; OpenCV camera (x right, y down, z forward), metres",
  camera: { ...camera, width, height },
  options: alignOptions(),
});

/** BOP's `scene_gt.json`: its models are in millimetres, so that each entry says what the mesh is to be multiplied by. */
export function bopText({ objects }: Scene): string {
  const entries = objects.map(({ pose, name }, i) => {
    const { entry, scale } = toBop(pose.value.transform, { objId: i + 1 });
    return { ...entry, name, model_mm_per_mesh_unit: 1000 * scale };
  });
  return JSON.stringify({ 0: entries }, null, 2);
}

/** The mesh where it is, at its real size; of a GLB with its materials. */
export function glbBytes({ pose, mesh, glb }: ObjectModel): Uint8Array {
  const { transform } = pose.value;
  return glb === null ? exportGlb(mesh, transform) : placeGlb(glb, transform);
}

/** The same as PLY, OpenCV camera frame. */
export const plyBytes = ({ pose, mesh }: ObjectModel): Uint8Array => exportPly(mesh, pose.value.transform);
