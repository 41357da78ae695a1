/** The image behind the meshes, seen from the depth camera: the photo, or the depth map in colours. */
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
} from "three/webgpu";
import { imageCorners } from "./frustum.js";
import type { SceneInput } from "./types.js";

/** A rectangle that covers exactly the image of the depth camera. */
export class Ground {
  readonly object: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly texture: DataTexture;

  constructor(scene: SceneInput, image: Uint8ClampedArray, depthM: number) {
    this.texture = new DataTexture(Uint8Array.from(image), scene.width, scene.height);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.minFilter = LinearFilter;
    this.texture.magFilter = LinearFilter;
    this.texture.needsUpdate = true;
    const geometry = new BufferGeometry();
    const corners = imageCorners(scene, depthM).flat();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(corners), 3));
    geometry.setAttribute("uv", new BufferAttribute(Float32Array.of(0, 0, 1, 0, 1, 1, 0, 1), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const material = new MeshBasicMaterial({
      map: this.texture,
      side: DoubleSide,
      depthTest: false,
      depthWrite: false,
      toneMapped: false,
    });
    this.object = new Mesh(geometry, material);
    // Before everything else.
    this.object.renderOrder = -1;
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    this.object.material.dispose();
    this.texture.dispose();
  }
}
