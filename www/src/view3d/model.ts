/** A mesh in the view, with its materials and its pose. */

import { ownDecoders } from "sim3align/input/own-decoders";
import { gltfText } from "sim3align/input/webp";
import { applyToObject3D } from "sim3align/three";
import type { Intersection, Material, Object3D, Raycaster } from "three/webgpu";
import type { Colouring } from "../pictures/light.js";
import { matrixOf, type Pose, poseOf, shifted } from "./pose.js";
import {
  BackSide,
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GLTFLoader,
  Group,
  Mesh,
  MeshBasicNodeMaterial,
  MeshStandardMaterial,
  normalLocal,
  positionLocal,
  uniform,
  Vector3,
} from "./three.js";
import type { Display, Matrix, ObjectInput } from "./types.js";

const white = new Color(0xffffff);

/** The corners of the box around an object along its axes. */
function cornersAround(content: Object3D): Vector3[] {
  const { min, max } = new Box3().setFromObject(content, true);
  const side = (bit: number, low: number, high: number) => (bit === 0 ? low : high);
  return [0, 1, 2, 3, 4, 5, 6, 7].map(
    (i) => new Vector3(side(i & 1, min.x, max.x), side(i & 2, min.y, max.y), side(i & 4, min.z, max.z)),
  );
}

/** What the lights of the view make of a surface that faces the viewer, on average. */
const MEAN_LIGHT = 1;

/** The outline's width as a share of the mesh's box diagonal. */
const outlineWidth = 0.006;

export class Model {
  /** Its origin is the mesh centre, which the gizmo rotates and scales about; its child shifts the mesh back. */
  readonly pivot = new Group();
  /** The centre of the bounding box, in the frame of the mesh. */
  readonly centre = new Vector3();
  /** Half the diagonal of the bounding box. */
  readonly radius: number;
  readonly colour: Color;
  private readonly outlines = new Group();
  private readonly materials: Material[] = [];
  private readonly outlineMaterials = new Map<number, Material>();
  private readonly box: readonly Vector3[];
  private isPlaced = false;
  colouring: Colouring = "textures";

  private constructor(
    readonly id: string,
    private readonly content: Object3D,
    { colour, corners }: ObjectInput,
  ) {
    this.colour = new Color(colour);
    content.updateMatrixWorld(true);
    this.box = corners?.map((corner) => new Vector3(...corner)) ?? cornersAround(content);
    const [first, last] = [this.box[0] as Vector3, this.box[7] as Vector3];
    this.centre.lerpVectors(first, last, 0.5);
    this.radius = first.distanceTo(last) / 2;
    const frame = new Group();
    frame.position.copy(this.centre).negate();
    frame.add(content, this.outlines);
    this.pivot.add(frame);
    this.pivot.visible = false;
    this.prepare();
  }

  /** Loads a mesh. The frame of a GLB is that of its scene, with node transforms applied. */
  static async load(object: ObjectInput): Promise<Model> {
    const { id, mesh } = object;
    if ("glb" in mesh) {
      const { meshoptDecoder } = await ownDecoders(gltfText(mesh.glb), {}, () => Promise.reject());
      // A copy, because the loader keeps views of the buffer.
      const { scene } = await new GLTFLoader()
        .setMeshoptDecoder(meshoptDecoder as Parameters<GLTFLoader["setMeshoptDecoder"]>[0])
        .parseAsync(mesh.glb.slice().buffer, "");
      return new Model(id, new Group().add(scene), object);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
    geometry.setIndex(new BufferAttribute(mesh.indices, 1));
    return new Model(id, new Group().add(new Mesh(geometry)), object);
  }

  /** All meshes of the content. */
  private meshes(): Mesh[] {
    const found: Mesh[] = [];
    this.content.traverse((object) => {
      if ((object as Mesh).isMesh) found.push(object as Mesh);
    });
    return found;
  }

  /** The first intersection of a ray with the mesh. */
  intersect(ray: Raycaster): Intersection | undefined {
    return ray.intersectObject(this.content, true)[0];
  }

  /** Adds normals, materials for the lights of this view, and outlines. */
  private prepare(): void {
    for (const mesh of this.meshes()) {
      if (!mesh.geometry.attributes.normal) mesh.geometry.computeVertexNormals();
      const given = Array.isArray(mesh.material) ? mesh.material[0] : mesh.material;
      mesh.material = this.materialFor(given, mesh.geometry);
      const hull = new Mesh(mesh.geometry, this.outlineAt(mesh.matrixWorld.getMaxScaleOnAxis()));
      hull.applyMatrix4(mesh.matrixWorld);
      this.outlines.add(hull);
    }
    this.outlines.visible = false;
  }

  /** The material of outlines of meshes whose node has this scale: quantised positions are large. */
  private outlineAt(scale: number): Material {
    const known = this.outlineMaterials.get(scale);
    if (known !== undefined) return known;
    const outline = new MeshBasicNodeMaterial({ side: BackSide, color: this.colour.clone().lerp(white, 0.7) });
    outline.positionNode = positionLocal.add(normalLocal.mul(uniform((2 * this.radius * outlineWidth) / scale)));
    this.outlineMaterials.set(scale, outline);
    this.materials.push(outline);
    return outline;
  }

  /** The given material or, for a mesh without colours, one in the colour of the object. */
  private materialFor(given: Material | undefined, { attributes }: BufferGeometry): Material {
    const standard = given as MeshStandardMaterial | undefined;
    if (attributes.color !== undefined) this.colouring = "vertices";
    const hasColours =
      attributes.color !== undefined ||
      Boolean(standard?.map) ||
      (standard?.color && standard.color.getHex() !== 0xffffff);
    if (standard?.isMeshStandardMaterial && hasColours) {
      // There is no environment map, so metals would be black. Meshes are opaque, whatever their files say.
      Object.assign(standard, { metalness: 0, transparent: false, depthWrite: true, opacity: 1 });
      standard.roughness = Math.max(0.5, standard.roughness);
      this.materials.push(standard);
      return standard;
    }
    given?.dispose();
    if (attributes.color === undefined) this.colouring = "plain";
    const material = new MeshStandardMaterial({ color: this.colour, roughness: 0.62, metalness: 0, side: DoubleSide });
    if (attributes.color !== undefined) {
      material.vertexColors = true;
      material.color.set(0xffffff);
    }
    this.materials.push(material);
    return material;
  }

  /** The pose, OpenCV camera from mesh; `null` until it is set. The mesh is hidden until then. */
  get pose(): Float64Array | null {
    if (!this.isPlaced) return null;
    const { position, quaternion, scale } = this.pivot;
    const placed: Pose = { position: position.clone(), quaternion: quaternion.clone(), scale: scale.x };
    return matrixOf(shifted(placed, this.centre.clone().negate()));
  }

  set pose(pose: Matrix) {
    this.isPlaced = true;
    this.pivot.visible = true;
    // The pivot's parent is in the OpenCV camera frame.
    applyToObject3D(this.pivot, matrixOf(shifted(poseOf(pose), this.centre)), { frame: "opencv" });
  }

  /** Gives the colours this light, linear; 1 leaves them as they are. */
  setLight(light: readonly number[]): void {
    for (const material of this.materials) {
      const { color, userData } = material as MeshStandardMaterial;
      if (!(material as MeshStandardMaterial).isMeshStandardMaterial) continue;
      userData.own ??= color.toArray();
      color.fromArray(userData.own.map((own: number, k: number) => (own * (light[k] ?? 1)) / MEAN_LIGHT));
    }
  }

  /** The corners of the box in the OpenCV camera frame, bit k of an index for side k; `null` while it is hidden. */
  corners(): Vector3[] | null {
    if (!this.pivot.visible) return null;
    const { position, quaternion, scale } = this.pivot;
    return this.box.map((corner) =>
      corner.clone().sub(this.centre).multiply(scale).applyQuaternion(quaternion).add(position),
    );
  }

  /** Applies display settings and the highlight. */
  show(display: Display, isSelected: boolean, isHidden = false): void {
    this.pivot.visible = this.isPlaced && display.mesh && !isHidden;
    this.outlines.visible = isSelected && !display.wireframe;
    for (const material of this.materials) {
      const standard = material as MeshStandardMaterial;
      if (standard.isMeshStandardMaterial) standard.wireframe = display.wireframe;
    }
  }

  dispose(): void {
    this.pivot.removeFromParent();
    for (const mesh of this.meshes()) mesh.geometry.dispose();
    for (const material of this.materials) {
      for (const value of Object.values(material)) if (value?.isTexture) value.dispose();
      material.dispose();
    }
  }
}
