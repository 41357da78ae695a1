/** The image behind the meshes, seen from the depth camera: the photo, or the depth map in colours. */
import type { BufferGeometry } from "three/webgpu";
import { geometryOf, imageCorners } from "./lines.js";
import {
  BufferAttribute,
  DataTexture,
  DoubleSide,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
} from "./three.js";
import type { SceneInput } from "./types.js";

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
