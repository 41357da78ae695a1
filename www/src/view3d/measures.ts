/** Lines with their lengths: the sides of a bounding box. */
import type { ColorRepresentation, Sprite, Vector3 } from "three/webgpu";
import { labelOf, lengthText } from "./label.js";
import { geometryOf, linesOf } from "./lines.js";
import { release } from "./parts.js";
import { Group } from "./three.js";

/** A line, and where its length is written; OpenCV camera frame, metres. */
export interface Measure {
  from: Vector3;
  to: Vector3;
  label: Vector3;
}

export class Measures {
  readonly object = new Group();
  /** Drawing a text takes time, so a label stays until its length changes. */
  readonly labels: Sprite[] = [];
  private readonly lines;
  private shown = "";

  constructor(color: ColorRepresentation, renderOrder: number) {
    this.lines = linesOf([], { color, depthTest: false });
    this.lines.renderOrder = renderOrder;
    this.object.add(this.lines);
  }

  /** Shows these lines only; their lengths in metres or, with a `unit`, as multiples of it. */
  show(measures: readonly Measure[], unit: number | null = null): void {
    const positions = measures.flatMap(({ from, to }) => [...from.toArray(), ...to.toArray()]);
    const key = `${unit}: ${positions.map((x) => x.toFixed(5)).join()}`;
    if (key === this.shown) return;
    this.shown = key;
    this.object.visible = measures.length > 0;
    this.lines.geometry.dispose();
    this.lines.geometry = geometryOf(positions);
    for (const label of this.labels.splice(measures.length)) release(label);
    const lengths = measures.map(({ from, to }) => from.distanceTo(to));
    for (const [i, { label }] of measures.entries())
      this.labelAt(i, lengthText(lengths[i] ?? 0, unit, Math.max(...lengths))).position.copy(label);
  }

  private labelAt(i: number, text: string): Sprite {
    const known = this.labels[i];
    if (known?.userData.text === text) return known;
    release(known);
    const label = labelOf(text);
    label.userData.text = text;
    this.labels[i] = label;
    this.object.add(label);
    return label;
  }

  dispose(): void {
    this.show([]);
    this.object.removeFromParent();
    release(this.lines);
  }
}
