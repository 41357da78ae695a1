/** The ruler: a line between two points, with its length. */
import {
  BufferAttribute,
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Sprite,
  Vector3,
} from "three/webgpu";
import { labelOf, lengthText, removeLabel } from "./label.js";

export class Ruler {
  readonly object = new Group();
  private readonly line: LineSegments<BufferGeometry, LineBasicMaterial>;
  private label: Sprite | null = null;

  constructor() {
    this.line = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: 0xffd23f, depthTest: false }));
    this.line.renderOrder = 4;
    this.object.add(this.line);
    this.object.visible = false;
  }

  /** Shows the line between two points of the OpenCV camera frame; fewer points hide it. */
  show(points: readonly (readonly [number, number, number])[]): void {
    const [from, to] = points.map((point) => new Vector3(...point));
    if (this.label) removeLabel(this.label);
    this.label = null;
    this.object.visible = from !== undefined && to !== undefined;
    if (from === undefined || to === undefined) return;
    this.line.geometry.dispose();
    this.line.geometry = new BufferGeometry();
    this.line.geometry.setAttribute("position", new BufferAttribute(Float32Array.from([...from, ...to]), 3));
    this.label = labelOf(lengthText(from.distanceTo(to)));
    this.label.position.copy(from).lerp(to, 0.5);
    this.object.add(this.label);
  }

  /** The labels that are shown. */
  get shownLabels(): readonly Sprite[] {
    return this.label === null ? [] : [this.label];
  }

  dispose(): void {
    this.show([]);
    this.object.removeFromParent();
    this.line.geometry.dispose();
    this.line.material.dispose();
  }
}
