/** Dimension lines: the sides of an object's bounding box, with their lengths. */
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Sprite,
  Vector3,
} from "three/webgpu";
import { labelOf, lengthText, removeLabel } from "./label.js";
import type { Model } from "./model.js";

/** The distance of a label from its line, as a share of the box's diagonal. */
const APART = 0.07;

/** The lines and labels of one object, in the OpenCV camera frame. */
export class Dimensions {
  readonly object = new Group();
  private readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
  /** By axis. Drawing a text takes time, so the label of a length stays until the length changes. */
  private readonly labels = new Map<number, { text: string; sprite: Sprite }>();
  private shown = "";

  constructor() {
    const material = new LineBasicMaterial({ color: new Color(0xffffff), depthTest: false });
    this.lines = new LineSegments(new BufferGeometry(), material);
    this.lines.renderOrder = 2;
    this.object.add(this.lines);
    this.object.visible = false;
  }

  /** Shows the size of a model at its present pose, or only its longest side; `null` hides the lines. */
  show(model: Model | null, sides: "all" | "longest" = "all"): void {
    const corners = model?.corners() ?? null;
    this.object.visible = corners !== null;
    if (corners === null) return;
    const key = [sides, ...corners.map((corner) => corner.toArray().map((x) => x.toFixed(5)))].join();
    if (key === this.shown) return;
    this.shown = key;
    const positions: number[] = [];
    const centre = corners.reduce((sum, corner) => sum.add(corner), new Vector3()).divideScalar(corners.length);
    const diagonal = (corners[0] as Vector3).distanceTo(corners[7] as Vector3);
    const edges = [0, 1, 2].map((axis) => edge(corners, axis));
    const longest = Math.max(...edges.map(([from, to]) => from.distanceTo(to)));
    for (const [axis, [from, to]] of edges.entries()) {
      const isShown = sides === "all" || from.distanceTo(to) === longest;
      const shown = this.labels.get(axis)?.sprite;
      if (shown !== undefined) shown.visible = isShown;
      if (!isShown) continue;
      positions.push(...from.toArray(), ...to.toArray());
      const middle = from.clone().lerp(to, 0.5);
      const outwards = middle.clone().sub(centre).normalize();
      const label = this.label(axis, lengthText(from.distanceTo(to)));
      label.position.copy(middle).addScaledVector(outwards, APART * diagonal);
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));
  }

  private label(axis: number, text: string): Sprite {
    const shown = this.labels.get(axis);
    if (shown?.text === text) return shown.sprite;
    if (shown !== undefined) removeLabel(shown.sprite);
    const sprite = labelOf(text);
    this.labels.set(axis, { text, sprite });
    this.object.add(sprite);
    return sprite;
  }

  /** The labels that are shown. */
  get shownLabels(): readonly Sprite[] {
    if (!this.object.visible) return [];
    return [...this.labels.values()].map(({ sprite }) => sprite).filter(({ visible }) => visible);
  }

  dispose(): void {
    for (const { sprite } of this.labels.values()) removeLabel(sprite);
    this.labels.clear();
    this.object.removeFromParent();
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}

/** Of the four edges along an axis, the one nearest to the viewer's lower right. Bit k of a corner is its side on axis k. */
function edge(corners: readonly Vector3[], axis: number): readonly [Vector3, Vector3] {
  const starts = [0, 1, 2, 3, 4, 5, 6, 7].filter((corner) => (corner & (1 << axis)) === 0);
  const pairs = starts.map((start) => [corners[start], corners[start | (1 << axis)]] as [Vector3, Vector3]);
  const score = ([from, to]: readonly [Vector3, Vector3]) => {
    const middle = from.clone().lerp(to, 0.5);
    return (0.35 * middle.x + middle.y) / middle.z - 0.8 * middle.z;
  };
  return pairs.reduce((best, pair) => (score(pair) > score(best) ? pair : best));
}
