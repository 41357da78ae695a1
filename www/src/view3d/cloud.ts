/** The point cloud: all points of a depth map in one draw call, as squares of an adjustable size. */
import type { Node, PerspectiveCamera } from "three/webgpu";
import { release } from "./parts.js";
import { type Points, pointsOf, type Rgb, tonesOf } from "./points.js";
import {
  attribute,
  BufferAttribute,
  BufferGeometry,
  Color,
  cameraProjectionMatrix,
  colorSpaceToWorking,
  float,
  Mesh,
  modelViewMatrix,
  NodeMaterial,
  positionGeometry,
  SRGBColorSpace,
  uniform,
  Vector2,
  vec2,
  vec4,
  vertexIndex,
} from "./three.js";
import type { ObjectInput, SceneInput } from "./types.js";

/** Share of the object's colour in the colour of its points; with a photo, its own colours stay. */
const highlight = { selected: 0.55, others: 0.38 };
const highlightOfPhoto = { selected: 0.28, others: 0.2 };

/** The sRGB components of a colour, 0 to 1. */
export const rgbOf = (color: Color): Rgb => {
  const { r, g, b } = color.getRGB({ r: 0, g: 0, b: 0 }, SRGBColorSpace);
  return [r, g, b];
};

/** How much farther away points are drawn, as a share of their distance: noise does not pierce a mesh that fits them. */
const BEHIND = 0.008;

/** The width of a point of the veil in pixels of the depth map: without gaps. */
const VEIL_WIDTH = 1.2;

/** A point cloud. */
export class Cloud {
  readonly object: Mesh<BufferGeometry, NodeMaterial>;
  /** The same points without those of objects, as depth only: in front of a photo, they hide the meshes behind them. */
  readonly veil: Mesh<BufferGeometry, NodeMaterial>;
  readonly points: Points;
  /** Half a point's width at one metre, in the directions of x and y. */
  private readonly halfWidth = uniform(new Vector2());
  private readonly veilWidth = uniform(new Vector2());
  /** Half a screen pixel at one metre, the lower bound. */
  private readonly minHalfWidth = uniform(0);
  private readonly tones: BufferAttribute;
  private base: Uint8Array;

  constructor(
    private readonly scene: SceneInput,
    near: Color,
    far: Color,
    maxPoints: number,
  ) {
    this.points = pointsOf(scene, maxPoints);
    this.base = tonesOf(scene, this.points, rgbOf(near), rgbOf(far));
    this.tones = new BufferAttribute(repeated(this.base, 4), 4, true);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(repeated(this.points.positions, 3), 3));
    geometry.setAttribute("tone", this.tones);
    geometry.setIndex(new BufferAttribute(squares(this.points.pixels.length), 1));
    this.object = new Mesh(geometry, this.material(vec2(this.halfWidth)));
    // The points of objects have no width there.
    const veil = this.material(vec2(this.veilWidth).mul(attribute<"vec4">("tone", "vec4").w));
    veil.colorWrite = false;
    this.veil = new Mesh(geometry, veil);
    this.veil.renderOrder = -1;
    this.veil.visible = false;
    // Computing their bounds would cost more than culling saves: the cloud is nearly always in view.
    this.object.frustumCulled = false;
    this.veil.frustumCulled = false;
    this.setWidth(this.veilWidth.value, VEIL_WIDTH);
  }

  /** Squares that face the screen, unlit, with half this width at one metre. */
  private material(width: Node<"vec2">): NodeMaterial {
    const exact = modelViewMatrix.mul(vec4(positionGeometry, 1));
    const inView = vec4(exact.xyz.mul(1 + BEHIND), 1);
    const corner = vec2(float(vertexIndex.bitAnd(1)), float(vertexIndex.shiftRight(1).bitAnd(1)))
      .mul(2)
      .sub(1);
    const least = vec2(this.minHalfWidth.mul(inView.z.negate()));
    const half = width.mul(positionGeometry.z).max(least.mul(width.x.greaterThan(0).select(1, 0)));
    const material = new NodeMaterial();
    material.vertexNode = cameraProjectionMatrix.mul(inView.add(vec4(corner.mul(half), 0, 0)));
    // The bytes are sRGB; the renderer computes in linear light.
    material.colorNode = colorSpaceToWorking(attribute<"vec4">("tone", "vec4"), SRGBColorSpace);
    material.lights = false;
    material.fog = false;
    return material;
  }

  /** Sets the width of a point, in pixels of the depth map. */
  setPointSize(size: number): void {
    this.setWidth(this.halfWidth.value, Math.max(1e-3, size));
  }

  private setWidth(halfWidth: Vector2, size: number): void {
    const { fx, fy } = this.scene.camera;
    const half = 0.5 * size * this.points.stride;
    halfWidth.set(half / fx, half / fy);
  }

  /** Sets the colours of a scene without a photo. */
  setTheme(near: Color, far: Color): void {
    if (!this.scene.rgba) this.base = tonesOf(this.scene, this.points, rgbOf(near), rgbOf(far));
  }

  /** Tints the points of each mask with the colour of its object. */
  highlight(objects: readonly ObjectInput[], selected: string | null): void {
    const tones = this.base.slice();
    const { pixels } = this.points;
    for (const { id, colour, mask } of objects) {
      const shares = this.scene.rgba ? highlightOfPhoto : highlight;
      const share = id === selected ? shares.selected : shares.others;
      const rgb = rgbOf(new Color(colour));
      for (let i = 0; i < pixels.length; i++) {
        if (!mask[pixels[i] as number]) continue;
        for (let at = 4 * i; at < 4 * i + 3; at++) {
          tones[at] = (1 - share) * (this.base[at] as number) + share * 255 * (rgb[at % 4] as number) + 0.5;
        }
        tones[4 * i + 3] = 0;
      }
    }
    (this.tones.array as Uint8Array).set(repeated(tones, 4));
    this.tones.needsUpdate = true;
  }

  /** Updates the size of a screen pixel. Call it before each frame. */
  prepare(camera: PerspectiveCamera, heightPx: number): void {
    const scale = camera.projectionMatrix.elements[5] ?? 1;
    this.minHalfWidth.value = 1 / (scale * Math.max(1, heightPx));
  }

  dispose(): void {
    release(this.veil);
    release(this.object);
  }
}

/** Repeats the numbers of each point for its four corners. Instancing is slower, in software renderers by far. */
function repeated<T extends Float32Array | Uint8Array>(numbers: T, size: number): T {
  const all = new (numbers.constructor as new (length: number) => T)(4 * numbers.length);
  for (let i = 0, to = 0; i < numbers.length; i += size) {
    for (let corner = 0; corner < 4; corner++) {
      for (let k = 0; k < size; k++) all[to++] = numbers[i + k] as number;
    }
  }
  return all;
}

/** Two triangles per point. Bit 0 of a corner is right, bit 1 is up. */
function squares(count: number): Uint32Array {
  const indices = new Uint32Array(6 * count);
  for (let i = 0; i < count; i++) {
    const corner = 4 * i;
    indices.set([corner, corner + 1, corner + 3, corner, corner + 3, corner + 2], 6 * i);
  }
  return indices;
}
