/** The dimension lines of all objects. */
import type { Group, PerspectiveCamera } from "three/webgpu";
import { spreadLabels } from "./label.js";
import { type Measure, Measures } from "./measures.js";
import type { Model } from "./model.js";
import { Vector3 } from "./three.js";

/** Of up to this many objects, those that are not selected show their longest sides; of more, the selected one alone is measured. */
const FEW = 3;

/** The distance of a label from its line, as a share of the box's diagonal. */
const APART = 0.07;

export class Sizes {
  private readonly measures = new Map<string, Measures>();

  constructor(private readonly root: Group) {}

  /** Shows the sizes of those models that `isShown` allows, in metres or as multiples of a `unit`. */
  update(
    models: ReadonlyMap<string, Model>,
    selected: string | null,
    unit: number | null,
    isShown: (id: string) => boolean,
  ): void {
    for (const [id, measures] of this.measures) {
      if (models.has(id)) continue;
      measures.dispose();
      this.measures.delete(id);
    }
    for (const [id, model] of models) {
      const measures = this.measures.get(id) ?? new Measures(model.colour, 2);
      this.root.add(measures.object);
      this.measures.set(id, measures);
      const corners = (id === selected || models.size <= FEW) && isShown(id) ? model.corners() : null;
      const sides = corners === null ? [] : sidesOf(corners);
      const lengths = sides.map(({ from, to }) => from.distanceTo(to));
      measures.show(id === selected ? sides : sides.filter((_, i) => lengths[i] === Math.max(...lengths)), unit);
    }
  }

  /** The lines and labels. */
  get objects(): Group[] {
    return [...this.measures.values()].map(({ object }) => object);
  }

  /** Keeps the labels apart from one another, as seen from the camera in a view of this height in CSS pixels. */
  spread(camera: PerspectiveCamera, viewPx: number): void {
    const shown = [...this.measures.values()].filter(({ object }) => object.visible);
    // Those of the selected object, which are more.
    shown.sort((a, b) => b.labels.length - a.labels.length);
    spreadLabels(
      shown.flatMap(({ labels }) => labels),
      camera,
      viewPx,
    );
  }

  dispose(): void {
    for (const measures of this.measures.values()) measures.dispose();
    this.measures.clear();
  }
}

/** The sides of a box, of which bit k of a corner is the side on axis k: of each four, the one nearest to the viewer's lower right. */
function sidesOf(corners: readonly Vector3[]): Measure[] {
  const centre = corners.reduce((sum, corner) => sum.add(corner), new Vector3()).divideScalar(corners.length);
  const diagonal = (corners[0] as Vector3).distanceTo(corners[7] as Vector3);
  return [1, 2, 4].map((bit) => {
    const sides = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((start) => {
      if ((start & bit) !== 0) return [];
      const [from, to] = [corners[start] as Vector3, corners[start | bit] as Vector3];
      const middle = from.clone().lerp(to, 0.5);
      return [{ from, to, middle, score: (0.35 * middle.x + middle.y) / middle.z - 0.8 * middle.z }];
    });
    const { from, to, middle } = sides.reduce((best, side) => (side.score > best.score ? side : best));
    const outwards = middle.clone().sub(centre).normalize();
    outwards.multiplyScalar(APART * diagonal);
    return { from, to, label: middle.add(outwards), outwards };
  });
}
