/** What is around the objects: the image in the view from the depth camera, and lines for the cameras and the ground. */
import type { Color, Group } from "three/webgpu";
import { groundOf } from "./ground.js";
import { floorOf, frustumOf, type Lines } from "./lines.js";
import type { Extent } from "./points.js";
import { release } from "./release.js";
import type { Matrix, PlaneInput, SceneInput } from "./types.js";

export class Surroundings {
  private frustum: Lines | null = null;
  private floor: Lines | null = null;
  private image: ReturnType<typeof groundOf> | null = null;
  /** The other cameras. */
  private readonly others: Lines[] = [];
  /** About the depth of the nearest surfaces, metres. */
  private firstDepth = 1;

  constructor(private readonly root: Group) {}

  /** The image, if there is one. */
  get hasImage(): boolean {
    return this.image !== null;
  }

  /** The depths of the scene range from `first` to `last`, metres. */
  setScene(scene: SceneInput, first: number, last: number, colour: Color): void {
    release(this.frustum);
    release(this.image);
    this.firstDepth = first;
    this.frustum = frustumOf(scene, 0.22 * first, colour);
    this.image = scene.ground ? groundOf(scene, scene.ground, last) : null;
    this.root.add(this.frustum);
    if (this.image) this.root.add(this.image);
  }

  /** Shows the ground around an extent as a grid; `null` hides it. */
  setGround(plane: PlaneInput | null, { centre, radius }: Extent, colour: Color): void {
    release(this.floor);
    this.floor = plane && floorOf(plane, centre, radius, colour);
    if (this.floor) this.root.add(this.floor);
  }

  setCameras(poses: readonly Matrix[], scene: SceneInput | null, colour: Color): void {
    for (const frustum of this.others.splice(0)) release(frustum);
    if (!scene) return;
    for (const pose of poses) {
      const frustum = frustumOf(scene, 0.1 * this.firstDepth, colour);
      frustum.matrixAutoUpdate = false;
      frustum.matrix.fromArray(Array.from(pose));
      this.root.add(frustum);
      this.others.push(frustum);
    }
  }

  recolour(colour: Color): void {
    this.frustum?.material.color.copy(colour);
  }

  show(hasImage: boolean, hasLines: boolean): void {
    if (this.image) this.image.visible = hasImage;
    for (const lines of [this.frustum, this.floor, ...this.others]) if (lines) lines.visible = hasLines;
  }

  dispose(): void {
    for (const part of [this.floor, this.image, this.frustum, ...this.others]) release(part);
  }
}
