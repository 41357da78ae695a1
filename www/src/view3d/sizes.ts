/** The dimension lines of all objects. */
import type { Group, PerspectiveCamera, Sprite } from "three/webgpu";
import { Dimensions } from "./dimensions.js";
import { spreadLabels } from "./label.js";
import type { Model } from "./model.js";

/** Of up to this many objects, those that are not selected show their longest sides; of more, the selected one alone is measured. */
const FEW = 3;

export class Sizes {
  private readonly dimensions = new Map<string, Dimensions>();

  constructor(private readonly root: Group) {}

  /** Shows the sizes of those models that `isShown` allows. */
  update(models: ReadonlyMap<string, Model>, selected: string | null, isShown: (id: string) => boolean): void {
    for (const [id, dimensions] of this.dimensions) {
      if (models.has(id)) continue;
      dimensions.dispose();
      this.dimensions.delete(id);
    }
    for (const [id, model] of models) {
      const dimensions = this.dimensions.get(id) ?? new Dimensions();
      if (!this.dimensions.has(id)) this.root.add(dimensions.object);
      this.dimensions.set(id, dimensions);
      const isSelected = id === selected;
      dimensions.show((isSelected || models.size <= FEW) && isShown(id) ? model : null, isSelected ? "all" : "longest");
    }
  }

  /** Keeps the labels apart from one another and from others, as seen from the camera in a view of this height in CSS pixels. */
  spread(camera: PerspectiveCamera, viewPx: number, others: readonly Sprite[]): void {
    spreadLabels(
      [...others, ...[...this.dimensions.values()].flatMap(({ shownLabels }) => shownLabels)],
      camera,
      viewPx,
    );
  }

  dispose(): void {
    for (const dimensions of this.dimensions.values()) dimensions.dispose();
    this.dimensions.clear();
  }
}
