/** The meshes as the depth camera would see them, drawn anew when a pose changes. */
import { computed, type ReadonlySignal } from "@preact/signals";
import { type DrawnObject, drawn } from "../draw/composition.js";
import type { ObjectModel } from "../state/object-model.js";
import { scene, selected } from "../state/scene.js";

/** One for each object, so that a pose that changes draws one mesh. */
const ofObjects = computed<readonly ReadonlySignal<{ object: ObjectModel; shown: DrawnObject }>[]>(() => {
  const whole = scene.value;
  if (whole === null) return [];
  return whole.objects.map((object) =>
    computed(() => ({ object, shown: drawn(whole, object, object.pose.value.transform.matrix) })),
  );
});

/** Every object at its present pose. */
export const drawingsAt = computed<readonly DrawnObject[]>(() =>
  ofObjects.value.map(({ value: { object, shown } }) => ({ ...shown, isSelected: object === selected.value })),
);

/** Their depths alone. */
export const drawing = computed(() => drawingsAt.value.map(({ drawing }) => drawing));
