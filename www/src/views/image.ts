/** What the image view draws: the scene with its objects, zoomed. */
import { computed, effect, type ReadonlySignal, signal } from "@preact/signals";
import { depthRange } from "../draw/colours.js";
import { compose, type DrawnObject, drawObject } from "../draw/composition.js";
import { wholeImage, type Zoom, zoomToObjects } from "../draw/zoom.js";
import { once } from "../load/once.js";
import type { ObjectModel } from "../state/object-model.js";
import type { Workspace } from "../state/workspace.js";
import { groundOf } from "./ground.js";

/** The image of a workspace. */
export const imageOf = once((workspace: Workspace) => {
  const { layers, scene, selected } = workspace;

  /** Depends on the scene only, so that it is not computed again when display settings change. */
  const onObjects = computed(() => (scene.value === null ? wholeImage : zoomToObjects(scene.value)));

  const depthRangeOfScene = computed(() => (scene.value === null ? null : depthRange(scene.value.depthM)));

  /** The objects at their start poses. */
  const before = computed(() => {
    const whole = scene.value;
    return whole === null
      ? []
      : whole.objects.map((object) => drawObject(whole, object, object.start.transform.matrix));
  });

  /** One signal per object, so that a changed pose renders one mesh only. */
  const renderings = computed<readonly ReadonlySignal<{ object: ObjectModel; drawn: DrawnObject }>[]>(() => {
    const whole = scene.value;
    if (whole === null) return [];
    return whole.objects
      .filter(({ isShown }) => isShown.value)
      .map((object) =>
        computed(() => ({ object, drawn: drawObject(whole, object, object.pose.value.transform.matrix) })),
      );
  });

  /** The objects at their current poses. */
  const after = computed<readonly DrawnObject[]>(() =>
    renderings.value.map(({ value: { object, drawn } }) => ({ ...drawn, isSelected: object === selected.value })),
  );

  /** The zoom that wheel and drag have set, for one scene and one setting of “Zoom”. */
  const ownZoom = signal<Zoom | null>(null);

  const zoom = computed(() => ownZoom.value ?? (layers.value.zoom ? onObjects.value : wholeImage));

  effect(() => {
    void [scene.value, layers.value.zoom];
    ownZoom.value = null;
  });

  function draw(canvas: HTMLCanvasElement): void {
    const [whole, picture] = [scene.value, groundOf(workspace).ground.value];
    if (whole === null || picture === null) return;
    if (canvas.width !== whole.width || canvas.height !== whole.height) {
      canvas.width = whole.width;
      canvas.height = whole.height;
    }
    const shown = layers.value;
    const image = compose(whole, picture, shown.wipe > 0 ? before.value : [], after.value, shown, zoom.value);
    canvas.getContext("2d")?.putImageData(image, 0, 0);
  }

  return { after, depthRangeOfScene, draw, ownZoom, zoom };
});
