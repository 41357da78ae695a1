/** What is around the objects: the image in the view from the depth camera, and lines for the cameras and the ground. */
import type { BufferGeometry, Group } from "three/webgpu";
import { floorOf, frustumOf, geometryOf, imageCorners, type Lines } from "./lines.js";
import { release } from "./parts.js";
import type { Extent } from "./points.js";
import {
  BufferAttribute,
  Color,
  DataTexture,
  DoubleSide,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
} from "./three.js";
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

/** A rectangle that covers exactly the image of the depth camera. */
export function groundOf(
  scene: SceneInput,
  image: Uint8ClampedArray,
  depthM: number,
): Mesh<BufferGeometry, MeshBasicMaterial> {
  const map = new DataTexture(Uint8Array.from(image), scene.width, scene.height);
  map.colorSpace = SRGBColorSpace;
  map.minFilter = LinearFilter;
  map.magFilter = LinearFilter;
  map.needsUpdate = true;
  const geometry = geometryOf(imageCorners(scene, depthM).flat());
  geometry.setAttribute("uv", new BufferAttribute(Float32Array.of(0, 0, 1, 0, 1, 1, 0, 1), 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const hidden = { depthTest: false, depthWrite: false };
  const ground = new Mesh(geometry, new MeshBasicMaterial({ map, side: DoubleSide, toneMapped: false, ...hidden }));
  // Before everything else.
  ground.renderOrder = -1;
  ground.frustumCulled = false;
  ground.visible = false;
  return ground;
}

interface Theme {
  background: string;
  frustum: string;
  /** Colours of the points of a scene without a photo. */
  near: string;
  far: string;
}

const themes: Record<"light" | "dark", Theme> = {
  light: { background: "#eef1f5", frustum: "#7a8699", near: "#c9bfae", far: "#51698c" },
  dark: { background: "#14181f", frustum: "#67748a", near: "#d8cdba", far: "#35496b" },
};

/** The colours of a theme. The background is that of the host, if it is opaque. */
export function colours(theme: "light" | "dark", host: HTMLElement) {
  const { background, frustum, near, far } = themes[theme];
  const hostColour = getComputedStyle(host).backgroundColor;
  const isOpaque = /^rgb\(/.test(hostColour);
  return {
    background: new Color(isOpaque ? hostColour : background),
    frustum: new Color(frustum),
    near: new Color(near),
    far: new Color(far),
  };
}
