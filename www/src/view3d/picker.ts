/** What of a scene is at a place of the screen. */
import { type Group, Matrix4, type PerspectiveCamera, Raycaster, Vector2, type Vector3 } from "three/webgpu";
import type { Cloud } from "./cloud.js";
import type { Model } from "./model.js";
import { pickPoint, pixelOf } from "./pick.js";
import type { SceneInput } from "./types.js";

/** How far beside a point, in CSS pixels, it is still meant. */
const reachPx = 5;

/** What was found. */
export interface Picked {
  /** The mesh that it is a point of; undefined for a point of the cloud. */
  id?: string;
  /** OpenCV camera frame, metres. */
  point: [number, number, number];
  /** Where the depth camera has it. */
  pixel: { x: number; y: number } | null;
}

/** Finds by rays and projections. */
export class Picker {
  constructor(
    private readonly camera: PerspectiveCamera,
    private readonly root: Group,
  ) {}

  /** The nearest of meshes and points. */
  pick(
    place: { x: number; y: number },
    size: { width: number; height: number },
    models: readonly Model[],
    cloud: Cloud | null,
    scene: SceneInput | null,
  ): Picked | null {
    if (!scene) return null;
    const { camera, root } = this;
    camera.updateMatrixWorld();
    root.updateMatrixWorld();
    const mesh = this.pickMesh(place, size, models);
    const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    clip.multiply(root.matrixWorld);
    const point = cloud && pickPoint(cloud.points.positions, clip.elements, place, size, reachPx);
    if (mesh && !(point && point.distance < 0.99 * mesh.distance)) {
      const { x, y, z } = root.worldToLocal(mesh.point.clone());
      return { id: mesh.id, point: [x, y, z], pixel: pixelOf([x, y, z], scene) };
    }
    if (!point || !cloud) return null;
    const { positions, pixels } = cloud.points;
    const at = (axis: number) => positions[3 * point.index + axis] ?? 0;
    const pixel = pixels[point.index] ?? 0;
    return {
      point: [at(0), at(1), at(2)],
      pixel: { x: pixel % scene.width, y: Math.floor(pixel / scene.width) },
    };
  }

  private pickMesh(
    place: { x: number; y: number },
    size: { width: number; height: number },
    models: readonly Model[],
  ): { id: string; point: Vector3; distance: number } | null {
    const ray = new Raycaster();
    const at = new Vector2((2 * place.x) / size.width - 1, 1 - (2 * place.y) / size.height);
    ray.setFromCamera(at, this.camera);
    const hits = models
      .filter(({ pivot }) => pivot.visible)
      .flatMap((model) => {
        const hit = model.intersect(ray);
        return hit ? [{ id: model.id, point: hit.point, along: hit.distance }] : [];
      })
      .sort((a, b) => a.along - b.along);
    const [first] = hits;
    if (!first) return null;
    const inView = first.point.clone().applyMatrix4(this.camera.matrixWorldInverse);
    return { ...first, distance: -inView.z };
  }
}
