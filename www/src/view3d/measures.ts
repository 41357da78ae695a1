/** Lines with their lengths: the sides of a bounding box. */
import type { ColorRepresentation, Sprite, Vector3 } from "three/webgpu";
import { labelOf, lengthText } from "./label.js";
import { geometryOf, linesOf } from "./lines.js";
import { release } from "./parts.js";
import { Color, Group } from "./three.js";

/** A line, and where its length is written; OpenCV camera frame, metres. */
export interface Measure {
  from: Vector3;
  to: Vector3;
  label: Vector3;
  /** From the middle of the line to the label. */
  outwards: Vector3;
}

/** Shares of the line at which its label may be, best first. */
const PLACES = [0.5, 0.3, 0.7, 0.1, 0.9];

export class Measures {
  readonly object = new Group();
  /** Drawing a text takes time, so a label stays until its length changes. */
  readonly labels: Sprite[] = [];
  private readonly lines;
  private shown = "";

  constructor(
    private readonly color: ColorRepresentation,
    renderOrder: number,
  ) {
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
    for (const [i, { label, from, to, outwards }] of measures.entries()) {
      const sprite = this.labelAt(i, lengthText(lengths[i] ?? 0, unit, Math.max(...lengths)));
      sprite.position.copy(label);
      // Where else it may be: along its line.
      sprite.userData.places = PLACES.map((share) => from.clone().lerp(to, share).add(outwards));
    }
  }

  private labelAt(i: number, text: string): Sprite {
    const known = this.labels[i];
    if (known?.userData.text === text) return known;
    release(known);
    const label = labelOf(text, `#${new Color(this.color).getHexString()}`);
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
