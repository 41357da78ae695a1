/** The image behind the meshes, seen from the depth camera: the photo, or the depth map in colours. */
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
} from "three/webgpu";
import type { SceneInput } from "./types.js";

/** A rectangle that covers exactly the image of the depth camera. */
export class Ground {
  readonly object: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly texture: DataTexture;

  constructor({ camera, width, height, ground }: SceneInput, depthM: number) {
    this.texture = new DataTexture(
      Uint8Array.from(ground ?? new Uint8Array(4)),
      ground ? width : 1,
      ground ? height : 1,
    );
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.minFilter = LinearFilter;
    this.texture.magFilter = LinearFilter;
    this.texture.needsUpdate = true;
    const geometry = new BufferGeometry();
    const [left, top, right, bottom] = [-0.5, -0.5, width - 0.5, height - 0.5];
    const corner = (u: number, v: number) => [
      ((u - camera.cx) / camera.fx) * depthM,
      ((v - camera.cy) / camera.fy) * depthM,
      depthM,
    ];
    const corners = [corner(left, top), corner(right, top), corner(right, bottom), corner(left, bottom)];
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(corners.flat()), 3));
    geometry.setAttribute("uv", new BufferAttribute(Float32Array.of(0, 0, 1, 0, 1, 1, 0, 1), 2));
    // Both sides are drawn, whatever the winding.
    geometry.setIndex([0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2]);
    const material = new MeshBasicMaterial({
      map: this.texture,
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
